#include <sonopose/attitude/mahony.hpp>
#include <sonopose/math/rotation.hpp>

#include <cmath>

namespace sonopose::attitude {

void Mahony::reset(const Quaterniond& q_body_to_world) {
  q_body_to_world_ = q_body_to_world;
  integral_body_radps_.setZero();
}

void Mahony::update(const MahonySettings& settings, const Vector3d& angular_velocity_body_radps,
                    const Vector3d& specific_force_body_mps2, double dt_s) {
  Vector3d rate_body_radps = angular_velocity_body_radps;
  const double force_mps2 = specific_force_body_mps2.norm();
  if (force_mps2 > 0.0) {
    const Vector3d up_measured_body = specific_force_body_mps2 / force_mps2;
    const Vector3d error_body = up_measured_body.cross(math::up_in_body(q_body_to_world_));
    if (std::abs(force_mps2 - standard_gravity_mps2) <= settings.ki_gate_mps2) {
      integral_body_radps_ += settings.ki * dt_s * error_body;
    }
    rate_body_radps += settings.kp * error_body;
  }
  rate_body_radps += integral_body_radps_;
  q_body_to_world_ = (q_body_to_world_ * math::rotation_by(rate_body_radps * dt_s)).normalized();
}

void Mahony::turn_about_world_z(double angle_rad) {
  q_body_to_world_ = (math::rotation_about_z(angle_rad) * q_body_to_world_).normalized();
}

void Mahony::turn_in_world(const Vector3d& rotation_world_rad) {
  q_body_to_world_ = (math::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
}

}  // namespace sonopose::attitude
