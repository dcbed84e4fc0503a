#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/pose_input.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::ros2 {
namespace {

constexpr std::size_t pose_columns = 6;
constexpr std::size_t at_rotation = 3;

/// Covariance of the rotation about the fixed axes.
Eigen::Matrix3d rotation_covariance(const PoseWithCovarianceStamped& pose) {
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> all(&pose.pose.covariance[0]);
  return all.bottomRightCorner<3, 3>();
}

std::optional<Quaterniond> orientation_of(const Pose& pose) {
  constexpr double max_norm_error = 0.02;
  const auto& [x, y, z, w] = pose.orientation;
  const Quaterniond q(w, x, y, z);
  if (!(std::abs(q.squaredNorm() - 1) < max_norm_error)) return std::nullopt;  // also for NaN
  return q.normalized();
}

}  // namespace

Vector3d point_in_body(const Vector3d& point_base_m, const Mount& mount) {
  return mount.q_imu_to_base.conjugate() * (point_base_m - mount.imu_in_base_m);
}

PoseWithCovarianceStamped as_pose(const Odometry& odometry) {
  return {.header = odometry.header, .pose = odometry.pose};
}

PoseWithCovarianceStamped as_pose(const PoseStamped& pose) {
  return {.header = pose.header, .pose = {.pose = pose.pose, .covariance = {}}};
}

std::optional<PoseWithCovarianceStamped> as_pose(const Imu& imu) {
  if (imu.orientation_covariance[0] == -1) return std::nullopt;
  PoseWithCovarianceStamped pose{};
  pose.header = imu.header;
  pose.pose.pose.orientation = imu.orientation;
  for (std::size_t i = 0; i < 9; ++i) {
    pose.pose.covariance[(at_rotation + i / 3) * pose_columns + at_rotation + i % 3] =
        imu.orientation_covariance[i];
  }
  return pose;
}

PoseWithCovarianceStamped as_pose(const Float64& yaw_deg) {
  const double half_rad = 0.5 * yaw_deg.data * std::numbers::pi / 180.0;
  PoseWithCovarianceStamped pose{};
  pose.pose.pose.orientation = {.x = 0, .y = 0, .z = std::sin(half_rad), .w = std::cos(half_rad)};
  return pose;
}

ReceivedHeading heading(const PoseWithCovarianceStamped& pose, const PoseFrames& frames,
                        BeaconAddress address, TimeNs received_ns) {
  constexpr double min_horizontal = 0.1;
  const auto& stamp = pose.header.stamp;
  const auto measured_ns =
      stamp.sec == 0 && stamp.nanosec == 0 ? std::optional(received_ns) : from_ros(stamp);
  if (!measured_ns) return {std::nullopt, "their stamp is invalid"};
  const auto q_measured = orientation_of(pose.pose.pose);
  if (!q_measured) return {std::nullopt, "their orientation is not a rotation"};
  const Eigen::Matrix3d to_map = frames.stated_in_map.rotation.toRotationMatrix();
  const Vector3d x_axis = frames.stated_in_map.rotation * *q_measured *
                          frames.measured_in_base.rotation.conjugate() * frames.mount.q_imu_to_base *
                          Vector3d::UnitX();
  if (x_axis.head<2>().norm() < min_horizontal) return {std::nullopt, "the x axis of the IMU is vertical"};
  PairHeading heading{.address = address,
                      .emission_time_ns = *measured_ns,
                      .received_time_ns = std::max(*measured_ns, received_ns),
                      .heading_world_rad = std::atan2(x_axis.y(), x_axis.x()),
                      .valid = true,
                      .flags = heading_flag_of_body};
  const Eigen::Matrix3d stated = rotation_covariance(pose);
  if (stated.isZero(0)) return {heading, nullptr};
  const double variance_rad2 = (to_map * stated * to_map.transpose())(2, 2);
  if (!std::isfinite(variance_rad2)) return {heading, "the variance of yaw is not finite"};
  if (!(variance_rad2 > 0)) return {heading, "the variance of yaw is not positive"};
  heading.std_rad = std::sqrt(variance_rad2);
  if (heading.std_rad > max_heading_std_rad) {
    return {std::nullopt, "the standard deviation of yaw is above 60°"};
  }
  return {heading, nullptr};
}

std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, const PoseFrames& frames,
                                 BeaconAddress address, TimeNs received_ns) {
  auto stated = fix(pose, address, received_ns);
  if (!stated) return std::nullopt;
  const Eigen::Matrix3d to_map = frames.stated_in_map.rotation.toRotationMatrix();
  stated->position_world_m = frames.stated_in_map.translation_m + to_map * stated->position_world_m;
  if (stated->covariance_world_m2) {
    stated->covariance_world_m2 =
        Covariance<3>::from_matrix(to_map * stated->covariance_world_m2->matrix() * to_map.transpose());
  }
  stated->point_body_m = point_in_body(frames.measured_in_base.translation_m, frames.mount);
  return stated;
}

}  // namespace sonopose::ros2
