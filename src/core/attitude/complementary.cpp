#include <sonopose/attitude/complementary.hpp>

#include <cmath>

namespace sonopose::attitude {
namespace {

/// Returns `share` of the shortest turn from the measured up to the estimated one, in the world.
template <class Scalar>
Quaternion<Scalar> turn_to_level(const Vector3<Scalar>& up_measured_world, Scalar share) {
  // Axis measured × Z, and the angle about it; for opposite directions any level axis will do.
  const Vector3<Scalar> across(up_measured_world.y(), -up_measured_world.x(), 0);
  const Scalar sine = across.norm();
  const Scalar angle_rad = std::atan2(sine, up_measured_world.z());
  if (!(sine > 0)) return geometry::rotation_by(Vector3<Scalar>(share * angle_rad, 0, 0));
  return geometry::rotation_by(across * (share * angle_rad / sine));
}

}  // namespace

template <class Scalar>
void BasicComplementary<Scalar>::update(const Settings& settings, const Measurement<Scalar>& measurement) {
  const Scalar dt_s = measurement.dt_s;
  this->turn_in_body((measurement.angular_velocity_body_radps - this->gyro_bias_body_radps_) * dt_s);
  const Scalar share = 1 - std::pow(Scalar(settings.alpha), dt_s / Scalar(settings.alpha_step_s));

  Quaternion<Scalar>& q_body_to_world = this->q_body_to_world_;
  if (has_vertical_reference(measurement)) {
    const Vector3<Scalar> force_world_mps2 =
        q_body_to_world * measurement.specific_force_body_mps2 - measurement.acceleration_world_mps2;
    q_body_to_world = turn_to_level(force_world_mps2, share) * q_body_to_world;
  }
  const Vector3<Scalar> field_world_t = q_body_to_world * measurement.magnetic_field_body_t;
  if (has_level_part(field_world_t)) {
    q_body_to_world =
        geometry::rotation_about_z(share * heading_error_rad(field_world_t, measurement)) * q_body_to_world;
  }
  q_body_to_world.normalize();
}

template class BasicComplementary<float>;
template class BasicComplementary<double>;

}  // namespace sonopose::attitude
