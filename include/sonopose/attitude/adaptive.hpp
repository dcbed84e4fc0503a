#pragma once
/// \file
/// The default filter, which is not part of the specifications. It estimates the inclination from the
/// specific force, low-pass filtered in a frame that does not rotate, and the heading separately. It learns
/// the gyroscope offset at rest and in motion. Based on D. Laidig and T. Seel, "VQF: Highly accurate IMU
/// orientation estimation with bias estimation and magnetic disturbance rejection" (Information Fusion 91,
/// 2023).

#include <sonopose/attitude/bias.hpp>
#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/low_pass.hpp>
#include <sonopose/attitude/magnetic.hpp>
#include <sonopose/attitude/rest.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

template <class Number>
class BasicAdaptive {
public:
  using Scalar = Number;
  using Settings = AdaptiveFilterSettings;
  static constexpr std::string_view name = "adaptive";
  static constexpr double max_wait_s = 0.1;

  void reset(const Quaternion<Scalar>& q_body_to_world);

  /// One step:
  /// 1. q ← q ⊗ exp((ω − b)·dt).
  /// 2. The specific force is low-pass filtered in world axes. They do not rotate with the body, so its
  ///    back-and-forth motion averages out. q is then rotated so that the filtered force points up.
  /// 3. A share of the angle from the horizontal field to north corrects the heading, unless the field is
  ///    disturbed. This never changes the tilt.
  /// 4. Every 0.1 s the gyroscope offset b is estimated again.
  /// Each sensor counts for the time since its last measurement, up to max_wait_s.
  void update(const Settings& all, const Measurement<Scalar>& measurement);

  /// Rotates the estimate. The low-pass filter's vertical stays, so the accelerometer later corrects a tilt
  /// by this rotation.
  void turn_in_world(const Vector3<Scalar>& rotation_world_rad);

  [[nodiscard]] const Quaternion<Scalar>& orientation() const { return q_body_to_world_; }
  [[nodiscard]] const Vector3<Scalar>& gyro_bias_body_radps() const { return bias_.bias_body_radps; }
  void set_gyro_bias(const Vector3<Scalar>& bias_body_radps) { bias_.bias_body_radps = bias_body_radps; }

  template <class Visit>
  void for_each_field(const Visit& visit);

  bool operator==(const BasicAdaptive& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() &&
           force_world_ == other.force_world_ && since_force_s_ == other.since_force_s_ &&
           since_field_s_ == other.since_field_s_ && heading_share_ == other.heading_share_ &&
           rest_ == other.rest_ && bias_ == other.bias_ && magnetic_ == other.magnetic_;
  }

private:
  Vector3<Scalar> level(const AdaptiveSettings& settings, const Vector3<Scalar>& force_world_mps2,
                        Scalar dt_s);
  void update_heading(const Settings& all, const Measurement<Scalar>& measurement, Scalar dt_s);
  void update_inclination(const Settings& all, const Measurement<Scalar>& measurement);
  void learn_bias(const Settings& all);

  Quaternion<Scalar> q_body_to_world_ = Quaternion<Scalar>::Identity();
  LowPass<Vector3<Scalar>> force_world_;  ///< m/s²
  // Sensors may have different rates.
  Scalar since_force_s_ = 0;
  Scalar since_field_s_ = 0;
  Scalar heading_share_ = 1;  ///< least share of the next heading, so that the first ones are averaged
  RestState<Scalar> rest_;
  BiasState<Scalar> bias_;
  MagneticState<Scalar> magnetic_;
};

template <class Number>
template <class Visit>
void BasicAdaptive<Number>::for_each_field(const Visit& visit) {
  visit("q_body_to_world", q_body_to_world_);
  visit("force_world_mps2", force_world_.value);
  visit("force_slope_world_mps3", force_world_.slope);
  visit("force_age_s", force_world_.age_s);
  visit("since_force_s", since_force_s_);
  visit("since_field_s", since_field_s_);
  visit("heading_share", heading_share_);
  visit("rest.rate_mean_body_radps", rest_.rate_mean_body_radps);
  visit("rest.force_mean_body_mps2", rest_.force_mean_body_mps2);
  visit("rest.age_s", rest_.age_s);
  visit("rest.still_for_s", rest_.still_for_s);
  visit("bias.bias_body_radps", bias_.bias_body_radps);
  visit("bias.covariance", bias_.covariance);
  visit("bias.begun", bias_.begun);
  visit("bias.span_s", bias_.span_s);
  visit("bias.rotation_s", bias_.rotation_s);
  visit("bias.turned_world_rad", bias_.turned_world_rad);
  visit("bias.late_rotation", bias_.late_rotation.value);
  visit("bias.late_rotation_slope", bias_.late_rotation.slope);
  visit("bias.late_rotation_age_s", bias_.late_rotation.age_s);
  visit("bias.late_bias_world", bias_.late_bias_world.value);
  visit("bias.late_bias_world_slope", bias_.late_bias_world.slope);
  visit("bias.late_bias_world_age_s", bias_.late_bias_world.age_s);
  visit("magnetic.mean_level_t", magnetic_.mean.level_t);
  visit("magnetic.mean_up_t", magnetic_.mean.up_t);
  visit("magnetic.mean_age_s", magnetic_.mean_age_s);
  visit("magnetic.reference_level_t", magnetic_.reference.level_t);
  visit("magnetic.reference_up_t", magnetic_.reference.up_t);
  visit("magnetic.has_reference", magnetic_.has_reference);
  visit("magnetic.candidate_level_t", magnetic_.candidate.level_t);
  visit("magnetic.candidate_up_t", magnetic_.candidate.up_t);
  visit("magnetic.candidate_age_s", magnetic_.candidate_age_s);
  visit("magnetic.candidate_turned_s", magnetic_.candidate_turned_s);
  visit("magnetic.like_reference_s", magnetic_.like_reference_s);
  visit("magnetic.disturbed", magnetic_.disturbed);
  visit("magnetic.rejected_s", magnetic_.rejected_s);
}

extern template class BasicAdaptive<float>;
extern template class BasicAdaptive<double>;

using Adaptive = BasicAdaptive<double>;

}  // namespace sonopose::attitude
