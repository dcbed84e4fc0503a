#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/covariance.hpp>

#include <algorithm>
#include <numbers>

namespace sonopose::ros2 {
namespace {

/// Lower limit of standard deviations, so that no variance is zero.
constexpr double min_std = 1e-6;

Covariance3 variances(const Vector3d& std) {
  const Vector3d bounded = std.cwiseMax(min_std);
  return bounded.cwiseProduct(bounded).asDiagonal();
}

/// Standard deviations of unknown components: large, but usable by consumers.
constexpr double unknown_position_std_m = 1e3;
constexpr double unknown_velocity_std_mps = 1e2;
constexpr double unknown_yaw_std_rad = std::numbers::pi / std::numbers::sqrt3;  // uniform over the circle

/// Returns the covariance as a matrix, with `std_if_unknown` for unknown components.
template <int N>
Eigen::Matrix<double, N, N> filled(const Covariance<N>& covariance,
                                   const Eigen::Matrix<double, N, 1>& std_if_unknown) {
  Eigen::Matrix<double, N, N> matrix = covariance.matrix();
  for (int i = 0; i < N; ++i) {
    const double min_variance = min_std * min_std;
    const double variance = covariance.is_known(i) ? matrix(i, i) : std_if_unknown[i] * std_if_unknown[i];
    matrix(i, i) = std::max(variance, min_variance);
  }
  return matrix;
}

/// Returns the covariance of position and orientation in the world. Unknown tilt has the standard deviation
/// `noise.tilt_std_deg`.
Covariance6 world_covariance(const FusedPose& pose, const Noise& noise) {
  const double tilt_std_rad = noise.tilt_std_deg * geometry::radians_per_degree;
  Eigen::Matrix<double, 6, 1> std_if_unknown;
  std_if_unknown << Vector3d::Constant(unknown_position_std_m), tilt_std_rad, tilt_std_rad,
      unknown_yaw_std_rad;
  return filled(pose.pose_covariance, std_if_unknown);
}

/// v × as a matrix.
Covariance3 cross(const Vector3d& v) {
  Covariance3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// Returns J Σ Jᵀ, made exactly symmetric in spite of rounding errors.
template <class Matrix>
Matrix propagated(const Matrix& jacobian, const Matrix& covariance) {
  const Matrix result = jacobian * covariance * jacobian.transpose();
  return 0.5 * (result + result.transpose());
}

Covariance6 block_diagonal(const Covariance3& first, const Covariance3& second) {
  Covariance6 both = Covariance6::Zero();
  both.topLeftCorner<3, 3>() = first;
  both.bottomRightCorner<3, 3>() = second;
  return both;
}

}  // namespace

Covariance3 diagonal(double std) {
  return variances(Vector3d::Constant(std));
}

Covariance3 orientation_covariance(const FusedPose& pose, const Noise& noise) {
  return world_covariance(pose, noise).bottomRightCorner<3, 3>();
}

Covariance6 pose_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise) {
  // p_base = p_imu − R r, and a small rotation δθ about the map axes changes R r to R r + δθ × R r.
  const Quaterniond q_base_to_map = base_state(pose, mount).q_base_to_map;
  Covariance6 jacobian = Covariance6::Identity();
  jacobian.topRightCorner<3, 3>() = cross(q_base_to_map * mount.imu_in_base_m);
  return propagated(jacobian, world_covariance(pose, noise));
}

Covariance6 twist_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise) {
  const Covariance3 map_to_base = base_state(pose, mount).q_base_to_map.conjugate().toRotationMatrix();
  // A small rotation δθ changes Rᵀ v to Rᵀ (v − δθ × v), so the error is Rᵀ (v ×) δθ.
  const Covariance3 rotation_jacobian = map_to_base * cross(pose.velocity_world_mps);
  const Covariance3 in_world =
      filled(pose.velocity_covariance, Vector3d(Vector3d::Constant(unknown_velocity_std_mps)));
  const Covariance3 of_velocity =
      propagated(map_to_base, in_world) + propagated(rotation_jacobian, orientation_covariance(pose, noise));
  // v_base = Rᵀ v − ω × r = Rᵀ v + (r ×) ω.
  Covariance6 jacobian = Covariance6::Identity();
  jacobian.topRightCorner<3, 3>() = cross(mount.imu_in_base_m);
  return propagated(jacobian, block_diagonal(of_velocity, diagonal(noise.gyro_std_radps)));
}

Covariance3 fix_covariance(const Covariance3& full_weight, std::optional<double> weight) {
  return full_weight / std::clamp(weight.value_or(1.0), min_weight, 1.0);
}

Covariance3 fix_covariance(double fix_std_m, std::optional<double> weight) {
  return fix_covariance(diagonal(fix_std_m), weight);
}

Covariance6 without_orientation(const Covariance3& position) {
  return block_diagonal(position, diagonal(std::numbers::pi / std::numbers::sqrt3));
}

}  // namespace sonopose::ros2
