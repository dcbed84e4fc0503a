#include "autopilot/external_odometry.hpp"

#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/ros2/messages/covariance.hpp>

#include <cmath>
#include <limits>

namespace sonopose::autopilot {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Axes x, −y, −z: a half turn about x, which makes FRD of forward, left, up and back.
Matrix3 half_turn() {
  return Vector3d(1, -1, -1).asDiagonal();
}

/// Rows: the axes of the frame in the map. East is clockwise of north, seen from above.
Matrix3 map_to_frame(North north) {
  if (!north) return half_turn();
  const double c = std::cos(*north);
  const double s = std::sin(*north);
  Matrix3 axes;
  axes << c, s, 0, s, -c, 0, 0, 0, -1;
  return axes;
}

/// Raises variances to the square of `min_std`; unknown ones stay NaN.
template <class Block>
void raise_variances(Block&& covariance, double min_std) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) < min_std * min_std) covariance(i, i) = min_std * min_std;
  }
}

Matrix3 turned(const Matrix3& rotation, const Matrix3& covariance) {
  return rotation * covariance * rotation.transpose();
}

bool knows_velocity(const FusedPose& pose) {
  return pose.velocity_covariance.is_known(0) && pose.velocity_covariance.is_known(1) &&
         pose.velocity_covariance.is_known(2);
}

/// Fills in the velocity, and its covariances with the errors of rotation and orientation at the lever arm.
void add_velocity(ExternalOdometry& odometry, const FusedPose& pose, const ros2::Mount& mount,
                  const Matrix3& map_to_frame) {
  const ros2::BaseState base = ros2::base_state(pose, mount);
  const ros2::Noise noise;
  const Matrix3 base_to_map = base.q_base_to_map.toRotationMatrix();
  odometry.velocity_frame_mps = map_to_frame * base_to_map * base.velocity_base_mps;
  odometry.velocity_body_mps = half_turn() * base.velocity_base_mps;
  // v_base = v_imu − u with u = R (ω × r), and a small rotation δθ changes u by δθ × u.
  const Matrix3 lever = base_to_map * geometry::cross_matrix(mount.imu_in_base_m) * noise.gyro_std_radps;
  const Vector3d swing_map_mps = base_to_map * base.angular_velocity_base_radps.cross(mount.imu_in_base_m);
  const Matrix3 of_orientation =
      turned(geometry::cross_matrix(swing_map_mps), ros2::orientation_covariance(pose, noise));
  odometry.velocity_covariance_frame =
      turned(map_to_frame, pose.velocity_covariance.matrix() + lever * lever.transpose() + of_orientation);
  const Matrix3 in_base = ros2::twist_covariance(pose, mount, noise).topLeftCorner<3, 3>();
  odometry.velocity_covariance_body = turned(half_turn(), in_base);
  raise_variances(odometry.velocity_covariance_frame, min_velocity_std_mps);
  raise_variances(odometry.velocity_covariance_body, min_velocity_std_mps);
  const bool knows_yaw = odometry.q_body_to_frame.has_value();
  if (!knows_velocity(pose) || (!knows_yaw && !mount.imu_in_base_m.isZero())) {
    odometry.velocity_frame_mps.setConstant(unknown);
    odometry.velocity_covariance_frame.setConstant(unknown);
  }
  if (!knows_velocity(pose) || !knows_yaw) {
    odometry.velocity_body_mps.setConstant(unknown);
    odometry.velocity_covariance_body.setConstant(unknown);
  }
}

}  // namespace

ExternalOdometry external_odometry(const FusedPose& pose, const ros2::Mount& mount, North north) {
  const ros2::BaseState base = ros2::base_state(pose, mount);
  const Matrix3 to_frame = map_to_frame(north);
  const Matrix3 base_to_map = base.q_base_to_map.toRotationMatrix();
  ExternalOdometry odometry;
  odometry.time_ns = pose.time_ns;
  odometry.is_ned = north.has_value();
  odometry.position_frame_m = to_frame * base.position_map_m;
  odometry.angular_velocity_body_radps = half_turn() * base.angular_velocity_base_radps;

  const Matrix6 in_map = ros2::pose_covariance(pose, mount, ros2::Noise{});
  Matrix6 axes = Matrix6::Zero();
  axes.topLeftCorner<3, 3>() = to_frame;
  axes.bottomRightCorner<3, 3>() = to_frame;
  odometry.pose_covariance = axes * in_map * axes.transpose();
  raise_variances(odometry.pose_covariance.topLeftCorner<3, 3>(), min_position_std_m);
  raise_variances(odometry.pose_covariance.bottomRightCorner<3, 3>(), min_orientation_std_rad);
  Matrix3 in_body = turned(base_to_map.transpose(), in_map.bottomRightCorner<3, 3>());
  raise_variances(in_body, min_orientation_std_rad);
  odometry.orientation_variance_body_rad2 = in_body.diagonal();

  const bool knows_yaw = (pose.status & status_heading_unknown) == 0 && pose.pose_covariance.is_known(5);
  if (knows_yaw) {
    odometry.q_body_to_frame = Quaterniond(to_frame * base_to_map * half_turn()).normalized();
  } else {
    odometry.orientation_variance_body_rad2.setConstant(unknown);
    odometry.pose_covariance.bottomRows<3>().setConstant(unknown);
    odometry.pose_covariance.rightCols<3>().setConstant(unknown);
  }
  add_velocity(odometry, pose, mount, to_frame);
  return odometry;
}

}  // namespace sonopose::autopilot
