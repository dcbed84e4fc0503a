#include <sonopose/attitude/adaptive.hpp>

#include <algorithm>

namespace sonopose::attitude {

template <class Scalar>
void BasicAdaptive<Scalar>::reset(const Quaternion<Scalar>& q_body_to_world) {
  *this = BasicAdaptive();
  q_body_to_world_ = q_body_to_world;
}

template <class Scalar>
void BasicAdaptive<Scalar>::update(const Settings& all, const Measurement<Scalar>& measurement) {
  const Scalar dt_s = measurement.dt_s;
  const Vector3<Scalar> rate_body_radps = measurement.angular_velocity_body_radps - bias_.bias_body_radps;
  q_body_to_world_ = (q_body_to_world_ * geometry::rotation_by(rate_body_radps * dt_s)).normalized();

  since_force_s_ = std::min(since_force_s_ + dt_s, Scalar(max_wait_s));
  since_field_s_ = std::min(since_field_s_ + dt_s, Scalar(max_wait_s));
  if (!measurement.specific_force_body_mps2.isZero(0)) update_inclination(all, measurement);
  if (!measurement.magnetic_field_body_t.isZero(0)) {
    update_heading(all, measurement, since_field_s_);
    since_field_s_ = 0;
  }
}

/// Levels by the specific force. At rest it is used even if the acceleration is unknown.
template <class Scalar>
void BasicAdaptive<Scalar>::update_inclination(const Settings& all, const Measurement<Scalar>& measurement) {
  const Scalar dt_s = since_force_s_;
  since_force_s_ = 0;
  rest::update(all.rest, rest_, measurement, dt_s, bias::limit_radps<Scalar>(all.bias));
  if (!measurement.force_shows_vertical && !rest::is_resting(all.rest, rest_)) return;
  const Matrix3<Scalar> rotation = q_body_to_world_.toRotationMatrix();
  const Vector3<Scalar> force_world_mps2 =
      rotation * measurement.specific_force_body_mps2 - measurement.acceleration_world_mps2;
  const Vector3<Scalar> turn_world_rad = level(all.adaptive, force_world_mps2, dt_s);
  bias::collect(bias_, rotation, turn_world_rad, dt_s);
  if (bias::is_due(bias_)) learn_bias(all);
}

template <class Scalar>
void BasicAdaptive<Scalar>::learn_bias(const Settings& all) {
  const AdaptiveSettings& settings = all.adaptive;
  const auto accel_time_s = Scalar(settings.accel_time_s);
  bias::estimate(all.bias, bias_,
                 {rest::is_resting(all.rest, rest_), force_world_.is_settled(accel_time_s),
                  rest_.rate_mean_body_radps, accel_time_s});
}

/// Rotates the estimate and the state of the low-pass filter until the filtered force is vertical.
/// Returns the rotation.
template <class Scalar>
Vector3<Scalar> BasicAdaptive<Scalar>::level(const AdaptiveSettings& settings,
                                             const Vector3<Scalar>& force_world_mps2, Scalar dt_s) {
  force_world_.update(force_world_mps2, dt_s, Scalar(settings.accel_time_s));
  const Scalar force_mps2 = force_world_.value.norm();
  if (!(force_mps2 > 0)) return Vector3<Scalar>::Zero();
  const Vector3<Scalar> up = force_world_.value / force_mps2;
  // The shortest turn from u to Z is the quaternion (1 + u·Z, u × Z); for a half turn, any level axis will
  // do.
  Quaternion<Scalar> turn(1 + up.z(), up.y(), -up.x(), 0);
  if (turn.w() < Scalar(1e-6)) turn = Quaternion<Scalar>(0, 1, 0, 0);
  turn.normalize();
  q_body_to_world_ = (turn * q_body_to_world_).normalized();
  force_world_.value = Vector3<Scalar>(0, 0, force_mps2);
  force_world_.slope = turn * force_world_.slope;
  return Scalar(2) * turn.vec();
}

template <class Scalar>
void BasicAdaptive<Scalar>::update_heading(const Settings& all, const Measurement<Scalar>& measurement,
                                           Scalar dt_s) {
  const Vector3<Scalar> field_world_t = q_body_to_world_ * measurement.magnetic_field_body_t;
  if (!has_level_part(field_world_t)) return;
  const Scalar rate_radps = measurement.angular_velocity_body_radps.norm();
  const Scalar weight = magnetic::update(all.magnetic, magnetic_, field_world_t, rate_radps, dt_s);
  const AdaptiveSettings& settings = all.adaptive;
  const auto time_s = Scalar(settings.heading_time_s);
  // The n-th heading has a share of at least 1/n, until that is less than its usual share.
  const Scalar usual = weight * dt_s / (time_s + dt_s);
  const Scalar share = std::max(usual, heading_share_);
  heading_share_ /= 1 + heading_share_;
  if (heading_share_ * time_s < dt_s) heading_share_ = 0;
  if (!(share > 0)) return;
  turn_in_world(Vector3<Scalar>(0, 0, share * heading_error_rad(field_world_t, measurement)));
}

template <class Scalar>
void BasicAdaptive<Scalar>::turn_in_world(const Vector3<Scalar>& rotation_world_rad) {
  q_body_to_world_ = (geometry::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
  bias_.turned_world_rad += rotation_world_rad;
  if (rotation_world_rad.z() != 0) {
    force_world_.slope = geometry::rotation_about_z(rotation_world_rad.z()) * force_world_.slope;
  }
}

template class BasicAdaptive<float>;
template class BasicAdaptive<double>;

}  // namespace sonopose::attitude
