#pragma once
/// \file
/// Items 23 and 24: emergency damping of a velocity that leads away from the last valid fix.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>

namespace sonopose::estimation::documented {

struct RunawaySettings {
  double position_error_m{};
  double velocity_damp_max_hz{};

  static constexpr std::string_view group = "runaway";
  static constexpr auto declarations() {
    using G = RunawaySettings;
    using settings::real;
    return settings::rows(
        real(23, "position_error_m", &G::position_error_m, 1.5, {0.01, 1000.0}, "m",
             "Distance from the last valid fix beyond which a velocity that leads away from it is damped."),
        real(24, "velocity_damp_max_hz", &G::velocity_damp_max_hz, 10.0, {0.0, 100.0}, "1/s",
             "Rate of that damping at twice the distance and beyond; it rises linearly from zero."));
  }
  constexpr RunawaySettings() { settings::set_defaults(*this); }
};

struct RunawayState {
  bool has_fix = false;
  Vector3d fix_position_world_m = Vector3d::Zero();  ///< last valid fix

  bool operator==(const RunawayState&) const = default;
};

namespace runaway {

/// Damps the velocity over one IMU step where the body is far from the last valid fix and moving away.
void damp(const RunawaySettings& settings, const RunawayState& state, Kinematics& body, double dt_s);

}  // namespace runaway
}  // namespace sonopose::estimation::documented
