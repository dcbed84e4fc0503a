#pragma once
/// \file
/// Small rotation helpers: Hamilton quaternions `q_body_to_world`, right-handed, Z up, angles in radians.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonopose::geometry {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <class Scalar>
using Quaternion = Eigen::Quaternion<Scalar>;

/// Wraps an angle to [−π, π].
template <class Scalar>
Scalar wrap_angle(Scalar angle_rad) {
  if (std::abs(angle_rad) <= std::numbers::pi_v<Scalar>) return angle_rad;  // most are; saves the division
  return std::remainder(angle_rad, 2 * std::numbers::pi_v<Scalar>);
}

/// Rotation by |v| about v: the exponential map, exact also for small angles.
template <class Derived>
Quaternion<typename Derived::Scalar> rotation_by(const Eigen::MatrixBase<Derived>& rotation_vector_rad) {
  using Scalar = typename Derived::Scalar;
  const Vector3<Scalar> vector = rotation_vector_rad;
  const Scalar angle_squared = vector.squaredNorm();
  // Below 0.2 rad the series to 8th order is exact to the last bit of a double, and faster.
  if (angle_squared < Scalar(0.04)) {
    const Scalar x = angle_squared;
    const Scalar sine_share =
        Scalar(1.0 / 2) -
        x * (Scalar(1.0 / 48) -
             x * (Scalar(1.0 / 3840) - x * (Scalar(1.0 / 645120) - x * Scalar(1.0 / 185794560))));
    const Scalar cosine =
        1 - x * (Scalar(1.0 / 8) -
                 x * (Scalar(1.0 / 384) - x * (Scalar(1.0 / 46080) - x * Scalar(1.0 / 10321920))));
    const Vector3<Scalar> xyz = sine_share * vector;
    return {cosine, xyz.x(), xyz.y(), xyz.z()};
  }
  const Scalar angle = std::sqrt(angle_squared);
  const Vector3<Scalar> xyz = (std::sin(angle / 2) / angle) * vector;
  return {std::cos(angle / 2), xyz.x(), xyz.y(), xyz.z()};
}

/// Overload that takes a vector in braces.
inline Eigen::Quaterniond rotation_by(const Eigen::Vector3d& rotation_vector_rad) {
  return rotation_by<Eigen::Vector3d>(rotation_vector_rad);
}

/// Rotation about world Z, counter-clockwise seen from above.
template <class Scalar>
Quaternion<Scalar> rotation_about_z(Scalar yaw_rad) {
  return rotation_by(Vector3<Scalar>(0, 0, yaw_rad));
}

/// Direction of body X in the world's XY plane, counter-clockwise from +X (ZYX Euler yaw).
template <class Scalar>
Scalar yaw_of(const Quaternion<Scalar>& q_body_to_world) {
  const auto& q = q_body_to_world;
  return std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

/// ZYX Euler angles (rad): world = Rz(yaw)·Ry(pitch)·Rx(roll)·body. At pitch = ±90° yaw and roll turn about
/// the same axis, and only their difference is meaningful.
template <class Scalar>
struct EulerAngles {
  Scalar roll_rad;
  Scalar pitch_rad;
  Scalar yaw_rad;
};

template <class Scalar>
EulerAngles<Scalar> euler_angles_of(const Quaternion<Scalar>& q_body_to_world) {
  const auto& q = q_body_to_world;
  const Scalar sine = 2 * (q.w() * q.y() - q.x() * q.z());
  return {std::atan2(2 * (q.w() * q.x() + q.y() * q.z()), 1 - 2 * (q.x() * q.x() + q.y() * q.y())),
          std::asin(std::clamp(sine, Scalar(-1), Scalar(1))), yaw_of(q)};
}

template <class Scalar>
Quaternion<Scalar> rotation_of(const EulerAngles<Scalar>& angles) {
  using Axis = Eigen::AngleAxis<Scalar>;
  return Axis(angles.yaw_rad, Vector3<Scalar>::UnitZ()) * Axis(angles.pitch_rad, Vector3<Scalar>::UnitY()) *
         Axis(angles.roll_rad, Vector3<Scalar>::UnitX());
}

/// World up (+Z) in body axes.
template <class Scalar>
Vector3<Scalar> up_in_body(const Quaternion<Scalar>& q_body_to_world) {
  const auto& q = q_body_to_world;
  return {2 * (q.x() * q.z() - q.w() * q.y()), 2 * (q.y() * q.z() + q.w() * q.x()),
          1 - 2 * (q.x() * q.x() + q.y() * q.y())};
}

/// Shortest rotation from the direction of `from` to that of `to`. For opposite directions it is a half turn
/// about some perpendicular axis, for a zero vector the identity.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Attitude with the given yaw whose up agrees with a specific force measured at rest; level for a zero
/// force.
Eigen::Quaterniond level_with(const Eigen::Vector3d& specific_force_body, double yaw_rad);

}  // namespace sonopose::geometry
