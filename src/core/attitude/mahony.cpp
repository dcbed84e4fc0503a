#include <sonopose/attitude/mahony.hpp>
#include <sonopose/samples/samples.hpp>

#include <cmath>

namespace sonopose::attitude {
namespace {

/// Full error of the field: its measured direction against the one in the vertical plane of north with the
/// measured dip.
template <class Scalar>
Vector3<Scalar> full_magnetic_error(const Quaternion<Scalar>& q_body_to_world,
                                    const Measurement<Scalar>& measurement) {
  const Vector3<Scalar> measured_body = measurement.magnetic_field_body_t.normalized();
  const Vector3<Scalar> measured_world = q_body_to_world * measured_body;
  const Scalar level = measured_world.template head<2>().norm();
  const Vector3<Scalar> expected_world(level * measurement.north_world.x(),
                                       level * measurement.north_world.y(), measured_world.z());
  return measured_body.cross(q_body_to_world.conjugate() * expected_world);
}

/// Sine of the angle about the vertical from the level part of the field to north.
template <class Scalar>
Vector3<Scalar> heading_error(const Quaternion<Scalar>& q_body_to_world, const Vector3<Scalar>& up_body,
                              const Measurement<Scalar>& measurement) {
  const Vector3<Scalar> field_world = q_body_to_world * measurement.magnetic_field_body_t;
  if (!has_level_part(field_world)) return Vector3<Scalar>::Zero();
  const auto& north = measurement.north_world;
  const Scalar level = field_world.template head<2>().norm();
  return (field_world.x() * north.y() - field_world.y() * north.x()) / level * up_body;
}

}  // namespace

template <class Scalar>
void BasicMahony<Scalar>::update(const Settings& settings, const Measurement<Scalar>& measurement) {
  const Scalar dt_s = measurement.dt_s;
  const auto kp = Scalar(settings.kp);
  const auto ki = Scalar(settings.ki);
  const Quaternion<Scalar>& q_body_to_world = this->q_body_to_world_;
  const Vector3<Scalar> up_body = geometry::up_in_body(q_body_to_world);
  Vector3<Scalar> rate_body_radps = measurement.angular_velocity_body_radps;

  const Vector3<Scalar> force_body_mps2 = gravity_force_body(measurement, q_body_to_world);
  const Scalar force_mps2 = force_body_mps2.norm();
  if (force_mps2 > 0 && has_vertical_reference(measurement)) {
    const Vector3<Scalar> up_measured_body = force_body_mps2 / force_mps2;
    const Vector3<Scalar> error_body = up_measured_body.cross(up_body);
    if (std::abs(force_mps2 - Scalar(standard_gravity_mps2)) <= Scalar(settings.ki_gate_mps2)) {
      this->gyro_bias_body_radps_ -= ki * dt_s * error_body;
    }
    rate_body_radps += kp * error_body;
  }
  if (!measurement.magnetic_field_body_t.isZero(0)) {
    const bool full = settings.magnetic_error == MagneticError::full;
    const Vector3<Scalar> error_body = full ? full_magnetic_error(q_body_to_world, measurement)
                                            : heading_error(q_body_to_world, up_body, measurement);
    this->gyro_bias_body_radps_ -= ki * dt_s * error_body;
    rate_body_radps += (full ? kp : Scalar(settings.heading_kp)) * error_body;
  }
  this->turn_in_body((rate_body_radps - this->gyro_bias_body_radps_) * dt_s);
}

template class BasicMahony<float>;
template class BasicMahony<double>;

}  // namespace sonopose::attitude
