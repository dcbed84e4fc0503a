#pragma once
/// \file
/// The Mahony filter (settings 29, 30; the attitude document's "Mahony Filter"): the gyroscope integrated,
/// with a proportional and integral pull of the estimated up towards the measured specific force.

#include <sonopose/core/samples.hpp>
#include <sonopose/core/setting.hpp>

namespace sonopose::attitude {

/// Items 29 and 30.
struct MahonySettings {
  double kp{};
  double ki{};
  double ki_gate_mps2{};

  static constexpr std::string_view group = "attitude.mahony";
  static constexpr auto declarations() {
    using G = MahonySettings;
    using setting::real;
    return std::tuple{
        real(
            29, "kp", &G::kp, 0.01, {0.0, 10.0}, "1/s",
            "Speed at which tilt is corrected towards the measured gravity; higher reacts faster and is more "
            "easily misled by acceleration."),
        real(30, "ki", &G::ki, 0.001, {0.0, 0.1}, "1/s^2",
             "Rate at which a remaining gyro offset is learned from the tilt correction, over tens of "
             "seconds."),
        real(setting::own_setting, "ki_gate_mps2", &G::ki_gate_mps2, 0.5, {0.0, 1000.0}, "m/s^2",
             "The offset is learned only while the specific force differs from gravity by less than this: in "
             "a "
             "long turn the tilt correction is wrong all the time in one direction.")};
  }
  constexpr MahonySettings() { setting::set_defaults(*this); }
};

/// The filter as a value: copying it copies its state.
class Mahony {
public:
  /// Starts at `q_body_to_world` with the integral at zero.
  void reset(const Quaterniond& q_body_to_world);

  /// Goes on from a state that another one had.
  void restore(const Quaterniond& q_body_to_world, const Vector3d& integral_body_radps) {
    q_body_to_world_ = q_body_to_world;
    integral_body_radps_ = integral_body_radps;
  }

  /// One step of `dt_s` > 0 with body rates (rad/s, offset of the start-up calibration taken off) and
  /// specific force (m/s²; one of zero length corrects nothing).
  ///   e = v_measured × v_estimated;  ω' = ω + Kp·e + Ki·∫e dt;  q ← q ⊗ exp(ω'·dt)
  /// The increment stands on the right, as body rates demand, and is exact where the document's q̇ = ½ q ⊗ ω
  /// is of first order.
  void update(const MahonySettings& settings, const Vector3d& angular_velocity_body_radps,
              const Vector3d& specific_force_body_mps2, double dt_s);

  /// Turns the estimate about world Z; tilt and integral are untouched.
  void turn_about_world_z(double angle_rad);

  /// Turns the estimate by |v| about v, a vector in the world (rad); the integral is untouched.
  void turn_in_world(const Vector3d& rotation_world_rad);

  [[nodiscard]] const Quaterniond& orientation() const { return q_body_to_world_; }

  /// What the integral has learned: to be taken off the rates (rad/s, body).
  [[nodiscard]] Vector3d gyro_bias_body_radps() const { return -integral_body_radps_; }

  bool operator==(const Mahony& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() &&
           integral_body_radps_ == other.integral_body_radps_;
  }

private:
  Quaterniond q_body_to_world_ = Quaterniond::Identity();
  Vector3d integral_body_radps_ = Vector3d::Zero();
};

}  // namespace sonopose::attitude
