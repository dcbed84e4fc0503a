#pragma once
/// \file
/// Covariances of ROS 2 messages. Every variance is positive and has a source: the covariance of the fused
/// pose, the noise of the sensors, and the lever arm of the mount. docs/ros2.md has the formulas.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/samples/pose.hpp>

#include <Eigen/Core>

#include <optional>

namespace sonopose::ros2 {

/// Standard deviations per axis that samples and poses do not provide.
struct Noise {
  double gyro_std_radps = 0.005;
  double accel_std_mps2 = 0.05;
  double magnetic_std_t = 1e-6;
  double tilt_std_deg = 1.0;  ///< deviation of roll and pitch, for a pose that does not know its own
};

using Covariance3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
/// Covariance of x, y, z and rotations about the fixed axes X, Y, Z of the frame.
using Covariance6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// Covariance with the same variance for each axis, without correlations.
Covariance3 diagonal(double std);

/// Covariance of the orientation body → world, as a rotation about the world axes.
Covariance3 orientation_covariance(const FusedPose& pose, const Noise& noise);

/// Covariance of the pose of the base in the map. The lever arm transforms rotation errors of the IMU into
/// position errors.
Covariance6 pose_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise);

/// Covariance of the linear and angular velocity of the base, in the axes of the base. Includes the
/// orientation error, because the velocity of the pose is in world axes.
Covariance6 twist_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise);

/// Covariance of a fix, from that at full weight and the weight (0…1) that the fusion applied, which includes
/// doubt and trust. Without a report the weight is full. A rejected fix has `min_weight`.
Covariance3 fix_covariance(const Covariance3& full_weight, std::optional<double> weight);
Covariance3 fix_covariance(double fix_std_m, std::optional<double> weight);
inline constexpr double min_weight = 1e-4;

/// Covariance of a pose with unknown orientation: uniform over the circle about each axis.
Covariance6 without_orientation(const Covariance3& position);

}  // namespace sonopose::ros2
