#include <sonopose/geometry/rotation.hpp>

#include <cmath>

namespace sonopose::geometry {
namespace {

/// Unit vector, even if the squares of a tiny vector are zero or those of a huge one infinite.
Eigen::Vector3d direction_of(const Eigen::Vector3d& vector) {
  return std::isnormal(vector.squaredNorm()) ? vector.normalized() : vector.stableNormalized();
}

}  // namespace

// Eigen's FromTwoVectors does the same, but finds the axis of a half turn by a matrix decomposition, which
// takes ten seconds to compile.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  constexpr double nearly_opposite = 1e-12;
  const Eigen::Vector3d u = direction_of(from);
  const Eigen::Vector3d v = direction_of(to);
  if (u.isZero(0.0) || v.isZero(0.0)) return Eigen::Quaterniond::Identity();
  const double cosine = v.dot(u);
  Eigen::Quaterniond q;
  if (1.0 + cosine < nearly_opposite) {
    q.w() = 0.0;
    q.vec() = u.unitOrthogonal();
    return q;
  }
  const double twice_half_cosine = std::sqrt((1.0 + cosine) * 2.0);  // 2·cos(angle / 2)
  q.w() = twice_half_cosine * 0.5;
  q.vec() = u.cross(v) * (1.0 / twice_half_cosine);
  return q;
}

Eigen::Quaterniond level_with(const Eigen::Vector3d& specific_force_body, double yaw_rad) {
  const Eigen::Quaterniond q_tilt = rotation_between(specific_force_body, Eigen::Vector3d::UnitZ());
  return rotation_about_z(yaw_rad - yaw_of(q_tilt)) * q_tilt;
}

}  // namespace sonopose::geometry
