#pragma once
/// \file
/// Items 10 and 11: what happens while no valid fix arrives, or no IMU sample.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>

namespace sonopose::estimation::documented {

struct OutageSettings {
  double velocity_decay_rate_hz{};
  double stale_after_s{};
  double imu_gap_s{};

  static constexpr std::string_view group = "outage";
  static constexpr auto declarations() {
    using G = OutageSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(10, "velocity_decay_rate_hz", &G::velocity_decay_rate_hz, 1.0, {0.0, 100.0}, "1/s",
             "Rate at which velocity falls to zero in stale mode."),
        real(11, "stale_after_s", &G::stale_after_s, 1.0, {0.1, 60.0}, "s",
             "Without a valid fix for this long, stale mode begins: acceleration is no longer integrated."),
        real(own_setting, "imu_gap_s", &G::imu_gap_s, 0.25, {0.01, 5.0}, "s",
             "A silence of the IMU longer than this is not integrated over; the velocity only decays."));
  }
  constexpr OutageSettings() { settings::set_defaults(*this); }
};

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
