#pragma once
/// \file
/// Items 25 and 35–37: which acceleration is believed, and its integration into velocity and position
/// (the strapdown document's equations 1 and 2).

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>

namespace sonopose::estimation::documented {

struct MotionSettings {
  double accel_linear_threshold_mps2{};
  bool gyro_gate{};
  double gyro_gate_projection_radps{};
  double gyro_gate_freeze_radps{};

  static constexpr std::string_view group = "motion";
  static constexpr auto declarations() {
    using G = MotionSettings;
    using settings::real;
    return settings::rows(
        real(25, "accel_linear_threshold_mps2", &G::accel_linear_threshold_mps2, 30.0, {0.1, 1000.0}, "m/s^2",
             "World acceleration above which velocity is softly reduced."),
        settings::flag(
            35, "gyro_gate", &G::gyro_gate, true,
            "Hold acceleration back while the body turns too fast for it to be the tracked point's."),
        real(36, "gyro_gate_projection_radps", &G::gyro_gate_projection_radps, 3.0, {0.0, 100.0}, "rad/s",
             "Angular rate above which only the acceleration along the velocity is integrated."),
        real(37, "gyro_gate_freeze_radps", &G::gyro_gate_freeze_radps, 6.0, {0.0, 100.0}, "rad/s",
             "Angular rate above which no acceleration is integrated."));
  }
  constexpr MotionSettings() { settings::set_defaults(*this); }
};

namespace motion {

/// What of the acceleration is integrated: all, only the part along the velocity, or nothing (items 35–37).
[[nodiscard]] Vector3d gate(const MotionSettings& settings, const Kinematics& body,
                            const Vector3d& acceleration_world_mps2);

/// Whether the gate holds anything back at this rate.
[[nodiscard]] bool is_gated(const MotionSettings& settings, const Kinematics& body);

/// Velocity and position over `dt_s` at constant acceleration:
/// p += v·dt + ½·a·dt², v += a·dt, and the soft limiter of item 25 at the measured acceleration.
void integrate(const MotionSettings& settings, Kinematics& body, const Vector3d& acceleration_world_mps2,
               double dt_s);

/// One step of stale mode: on at the velocity that is left, whatever the acceleration.
void coast(Kinematics& body, double dt_s);

}  // namespace motion
}  // namespace sonopose::estimation::documented
