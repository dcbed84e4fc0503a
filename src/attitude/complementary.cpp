#include <sonopose/attitude/complementary.hpp>

#include <cmath>

namespace sonopose::attitude {
namespace {

/// `share` of the shortest turn that takes the measured up to where the estimate sees it, in the world.
template <class Scalar>
Quaternion<Scalar> turn_to_level(const Vector3<Scalar>& up_measured_world, Scalar share) {
  // measured × Z, and its angle; where both are opposite any level axis is as good.
  const Vector3<Scalar> across(up_measured_world.y(), -up_measured_world.x(), 0);
  const Scalar sine = across.norm();
  const Scalar angle_rad = std::atan2(sine, up_measured_world.z());
  if (!(sine > 0)) return math::rotation_by(Vector3<Scalar>(share * angle_rad, 0, 0));
  return math::rotation_by(across * (share * angle_rad / sine));
}

}  // namespace

template <class Scalar>
void BasicComplementary<Scalar>::update(const Settings& settings, const Measurement<Scalar>& measurement) {
  const Vector3<Scalar> rate_body_radps = measurement.angular_velocity_body_radps - gyro_bias_body_radps_;
  q_body_to_world_ = q_body_to_world_ * math::rotation_by(rate_body_radps * measurement.dt_s);
  const Scalar alpha = std::pow(Scalar(settings.alpha), measurement.dt_s / Scalar(settings.alpha_step_s));
  const Scalar share = 1 - alpha;

  const Vector3<Scalar> force_world =
      q_body_to_world_ * measurement.specific_force_body_mps2 - measurement.acceleration_world_mps2;
  if (!measurement.specific_force_body_mps2.isZero(0)) {
    q_body_to_world_ = turn_to_level(force_world, share) * q_body_to_world_;
  }
  const Vector3<Scalar> field_world = q_body_to_world_ * measurement.magnetic_field_body_t;
  if (field_world.x() != 0 || field_world.y() != 0) {
    const auto& north = measurement.north_world;
    const Scalar error_rad = std::atan2(field_world.x() * north.y() - field_world.y() * north.x(),
                                        field_world.x() * north.x() + field_world.y() * north.y());
    q_body_to_world_ = math::rotation_about_z(share * error_rad) * q_body_to_world_;
  }
  q_body_to_world_.normalize();
}

template <class Scalar>
void BasicComplementary<Scalar>::turn_in_world(const Vector3<Scalar>& rotation_world_rad) {
  q_body_to_world_ = (math::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
}

template class BasicComplementary<float>;
template class BasicComplementary<double>;

}  // namespace sonopose::attitude
