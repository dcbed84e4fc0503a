#pragma once
/// \file
/// How sure a message is. Every variance is positive and comes from somewhere: the fused pose's own standard
/// deviations (which follow the fixes' noise, weight and trust and grow without fixes), the sensors' noise,
/// and the mount's lever arm. docs/ros2.md has the formulas.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/samples/pose.hpp>

#include <Eigen/Core>

#include <optional>

namespace sonopose::ros2 {

/// What the samples and poses do not say of themselves: standard deviations, per axis.
struct Noise {
  double gyro_std_radps = 0.005;
  double accel_std_mps2 = 0.05;
  double magnetic_std_t = 1e-6;
  double tilt_std_deg = 1.0;  ///< of roll and pitch, for a pose that does not know its own
};

using Covariance3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
/// Over x, y, z and the turns about the fixed axes X, Y, Z of the frame.
using Covariance6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// The variance of each axis, and nothing between them.
Covariance3 diagonal(double std);

/// Of the orientation body → world, about the world's axes: tilt, tilt, yaw.
Covariance3 orientation_covariance(const FusedPose& pose, const Noise& noise);

/// Of the base's pose in the map. A turn of the IMU swings the base at the end of the lever arm.
Covariance6 pose_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise);

/// Of the base's velocity, linear and angular, in the base's axes. A velocity that is known in the world
/// only is turned by as much as the orientation is wrong.
Covariance6 twist_covariance(const FusedPose& pose, const Mount& mount, const Noise& noise);

/// Of a fix of the effective weight that the fusion gave it (0…1: noise, doubt and trust are in it), or of
/// full weight where no fusion said anything. A fix that it refused is of `least_weight`.
Covariance3 fix_covariance(double fix_std_m, std::optional<double> weight);
inline constexpr double least_weight = 1e-4;

/// Of a pose whose orientation nobody knows: uniform over the circle, about each axis.
Covariance6 without_orientation(const Covariance3& position);

}  // namespace sonopose::ros2
