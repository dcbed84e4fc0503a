#pragma once
/// \file
/// Items 10 and 11: what happens while no valid fix arrives, or no IMU sample.

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::OutageSettings;

/// How far the engine has got hold of the ultrasonic track.
enum class InitPhase {
  none,      ///< no fix yet, or stale: the next valid fix sets the position
  position,  ///< the next valid fix sets the velocity
  held
};

struct OutageState {
  TimeNs last_valid_fix_ns = 0;  ///< receipt of the last valid fix; 0 before the first
  InitPhase track = InitPhase::none;
  bool stale = false;

  bool operator==(const OutageState&) const = default;
};

namespace outage {

/// Whether two IMU samples are too far apart to integrate from one to the other.
[[nodiscard]] bool is_imu_gap(const OutageSettings& settings, double dt_s);

/// Whether what was at `then_ns` is not yet stale.
[[nodiscard]] bool is_recent(const OutageSettings& settings, TimeNs then_ns, TimeNs now_ns);

/// Whether acceleration must be ignored at `now_ns`; lets go of the track when stale mode begins.
bool watch(const OutageSettings& settings, OutageState& state, TimeNs now_ns);

/// One step of stale mode: the speed falls as exp(−rate·t).
void decay(const OutageSettings& settings, Kinematics& body, double dt_s);

}  // namespace outage
}  // namespace sonopose::estimation::documented
