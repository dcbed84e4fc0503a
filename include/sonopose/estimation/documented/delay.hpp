#pragma once
/// \file
/// Item 6: a fix tells where the beacon *was*; here it is moved on to the time of the engine's state.

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <string_view>

namespace sonopose::estimation::documented {

using settings::DelaySettings;
using settings::DelaySource;

/// A fix as the later stages see it.
struct TimedFix {
  TimeNs measured_ns = 0;  ///< when the beacon was there, by the delay that counts
  Vector3d measured_position_world_m = Vector3d::Zero();
  Vector3d shifted_position_world_m = Vector3d::Zero();  ///< where it is now, by the IMU's motion since
};

namespace delay {

/// When a measurement received at `received_ns` was made: its own delay or the fixed one.
[[nodiscard]] TimeNs measured_at(const DelaySettings& settings, const UltrasonicFix& fix);
[[nodiscard]] TimeNs measured_at(const DelaySettings& settings, const PairHeading& heading);

/// Moves a timed fix on to the state's time: by the IMU's own path since, which at constant velocity is the
/// document's v · delay and in a turn is better than it.
void move_on(const DelaySettings& settings, const Kinematics& body, TimedFix& fix);

/// Times the fix and moves it on.
[[nodiscard]] TimedFix shift(const DelaySettings& settings, const Kinematics& body, const UltrasonicFix& fix);

}  // namespace delay
}  // namespace sonopose::estimation::documented
