#include <sonopose/estimation/documented/motion.hpp>

#include <cmath>

namespace sonopose::estimation::documented::motion {

bool is_gated(const MotionSettings& settings, const Kinematics& body) {
  return settings.gyro_gate && body.angular_velocity_body_radps.norm() > settings.gyro_gate_projection_radps;
}

Vector3d gate(const MotionSettings& settings, const Kinematics& body,
              const Vector3d& acceleration_world_mps2) {
  if (!settings.gyro_gate) return acceleration_world_mps2;
  const double rate_radps = body.angular_velocity_body_radps.norm();
  if (rate_radps > settings.gyro_gate_freeze_radps) return Vector3d::Zero();
  if (rate_radps <= settings.gyro_gate_projection_radps) return acceleration_world_mps2;
  // A very slow velocity has no reliable direction.
  constexpr double min_speed_mps = 1e-3;
  const double speed_mps = body.velocity_world_mps.norm();
  if (speed_mps < min_speed_mps) return Vector3d::Zero();
  const Vector3d direction_world = body.velocity_world_mps / speed_mps;
  return acceleration_world_mps2.dot(direction_world) * direction_world;
}

void integrate(const MotionSettings& settings, Kinematics& body, const Vector3d& acceleration_world_mps2,
               double dt_s) {
  const Vector3d before_world_mps = body.velocity_world_mps;
  body.velocity_world_mps += acceleration_world_mps2 * dt_s;
  const double excess = body.acceleration_world_mps2.norm() / settings.accel_linear_threshold_mps2 - 1.0;
  if (excess > 0.0)
    body.velocity_world_mps *= std::exp(-excess * dt_s);  // item 25: 1/s at twice the threshold
  body.position_world_m += 0.5 * dt_s * (before_world_mps + body.velocity_world_mps);
}

void predict_without_imu(Kinematics& body, double dt_s) {
  body.position_world_m += body.velocity_world_mps * dt_s;
}

}  // namespace sonopose::estimation::documented::motion
