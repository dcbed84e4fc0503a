#pragma once
/// \file
/// Item 6: a fix is a past position of the beacon. This stage extrapolates it to the time of the engine's
/// state.

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::DelaySettings;
using settings::DelaySource;

/// A fix with its time of measurement.
struct TimedFix {
  TimeNs measured_ns = 0;  ///< time of measurement, by the selected delay (delay.source)
  Vector3d measured_position_world_m = Vector3d::Zero();
  Vector3d shifted_position_world_m =
      Vector3d::Zero();               ///< position extrapolated by the IMU's motion since then
  Vector3d share = Vector3d::Ones();  ///< share of each axis that counts, by the noise of the fixes (scatter)
};

namespace delay {

/// Extrapolates a timed fix to the state's time along the inertial path. At constant velocity this is the
/// document's v · delay; in a turn it is more accurate.
void extrapolate_to_now(const DelaySettings& settings, const Kinematics& body, TimedFix& fix);

/// Determines the time of the fix and extrapolates it.
[[nodiscard]] TimedFix extrapolated(const DelaySettings& settings, const Kinematics& body,
                                    const UltrasonicFix& fix);

}  // namespace delay
}  // namespace sonopose::estimation::documented
