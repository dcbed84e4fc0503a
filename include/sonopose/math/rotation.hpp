#pragma once
/// \file
/// Small rotation helpers: Hamilton quaternions `q_body_to_world`, right-handed, Z up, angles in radians.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace sonopose::math {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// The same angle in [−π, π].
inline double wrap_angle(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

/// The rotation by |v| about v: the exponential map, exact also for small angles.
inline Eigen::Quaterniond rotation_by(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle_squared = rotation_vector_rad.squaredNorm();
  // Below 1e-4 rad the series to 4th order is exact to the last bit of a double.
  if (angle_squared < 1e-8) {
    const double half_sinc = 0.5 - angle_squared / 48.0;
    const Eigen::Vector3d xyz = half_sinc * rotation_vector_rad;
    return {1.0 - angle_squared / 8.0, xyz.x(), xyz.y(), xyz.z()};
  }
  const double angle = std::sqrt(angle_squared);
  const Eigen::Vector3d xyz = (std::sin(0.5 * angle) / angle) * rotation_vector_rad;
  return {std::cos(0.5 * angle), xyz.x(), xyz.y(), xyz.z()};
}

/// Rotation about world Z, counter-clockwise seen from above.
inline Eigen::Quaterniond rotation_about_z(double yaw_rad) {
  return {std::cos(0.5 * yaw_rad), 0.0, 0.0, std::sin(0.5 * yaw_rad)};
}

/// Direction of body X in the world's XY plane, counter-clockwise from +X (ZYX Euler yaw).
inline double yaw_of(const Eigen::Quaterniond& q_body_to_world) {
  const auto& q = q_body_to_world;
  return std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()), 1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
}

/// World up (+Z) in body axes.
inline Eigen::Vector3d up_in_body(const Eigen::Quaterniond& q_body_to_world) {
  const auto& q = q_body_to_world;
  return {2.0 * (q.x() * q.z() - q.w() * q.y()), 2.0 * (q.y() * q.z() + q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

/// The attitude with the given yaw whose up agrees with a specific force measured at rest.
/// `specific_force_body` must not be zero.
inline Eigen::Quaterniond level_with(const Eigen::Vector3d& specific_force_body, double yaw_rad) {
  const auto q_tilt = Eigen::Quaterniond::FromTwoVectors(specific_force_body, Eigen::Vector3d::UnitZ());
  return rotation_about_z(yaw_rad - yaw_of(q_tilt)) * q_tilt;
}

}  // namespace sonopose::math
