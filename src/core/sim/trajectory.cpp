#include "sim/trajectory.hpp"

namespace sonopose::sim {

namespace {

Quaterniond attitude_of(double yaw, double pitch, double roll) {
  return Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Vector3d::UnitX());
}

}  // namespace

Motion motion_on(const Path& path) {
  const Jet sin_pitch = sin(path.pitch);
  const Jet cos_pitch = cos(path.pitch);
  const Jet sin_roll = sin(path.roll);
  const Jet cos_roll = cos(path.roll);
  // Rates as jets (their second derivative is unknown and unused).
  const Jet yaw_rate{path.yaw.rate, path.yaw.acceleration, 0.0};
  const Jet pitch_rate{path.pitch.rate, path.pitch.acceleration, 0.0};
  const Jet roll_rate{path.roll.rate, path.roll.acceleration, 0.0};
  const Jet rate_x = roll_rate - yaw_rate * sin_pitch;
  const Jet rate_y = pitch_rate * cos_roll + yaw_rate * cos_pitch * sin_roll;
  const Jet rate_z = yaw_rate * cos_pitch * cos_roll - pitch_rate * sin_roll;

  Motion motion;
  motion.position_world_m = {path.x.value, path.y.value, path.z.value};
  motion.velocity_world_mps = {path.x.rate, path.y.rate, path.z.rate};
  motion.acceleration_world_mps2 = {path.x.acceleration, path.y.acceleration, path.z.acceleration};
  motion.q_body_to_world = attitude_of(path.yaw.value, path.pitch.value, path.roll.value);
  motion.angular_velocity_body_radps = {rate_x.value, rate_y.value, rate_z.value};
  motion.angular_acceleration_body_radps2 = {rate_x.rate, rate_y.rate, rate_z.rate};
  return motion;
}

Jet smooth_departure(double time_s, double start_s, double ramp_s, double per_second) {
  const Jet progress{(time_s - start_s) / ramp_s, 1.0 / ramp_s, 0.0};
  return Jet{per_second * ramp_s} * smooth_start(progress);
}

Motion turned(const Motion& motion, const Vector3d& pivot_world_m, double yaw_rad) {
  const Quaterniond turn(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()));
  Motion result = motion;
  result.position_world_m = pivot_world_m + turn * (motion.position_world_m - pivot_world_m);
  result.velocity_world_mps = turn * motion.velocity_world_mps;
  result.acceleration_world_mps2 = turn * motion.acceleration_world_mps2;
  result.q_body_to_world = turn * motion.q_body_to_world;
  return result;
}

}  // namespace sonopose::sim
