#pragma once
/// \file
/// The pose of a vehicle in the axes of autopilots: north, east, down for the world, and forward, right, down
/// (FRD) for the body. Source: PX4's VehicleOdometry, MAVLink's ODOMETRY, REP-147.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/samples/pose.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <optional>

namespace sonopose::autopilot {

using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Direction of north in the map: counter-clockwise from its x axis. Empty: unknown.
using North = std::optional<double>;

/// Least standard deviations. A filter that is told less rejects the small errors of mount and clock.
inline constexpr double min_position_std_m = 0.01;
inline constexpr double min_orientation_std_rad = 0.01;
inline constexpr double min_velocity_std_mps = 0.02;

/// Motion of the vehicle's body. `frame`: north, east, down; or if north is unknown, the map's x, minus y,
/// minus z ("FRD" of the map). NaN: unknown.
struct ExternalOdometry {
  TimeNs time_ns = 0;
  bool is_ned = false;  ///< north is known
  Vector3d position_frame_m = Vector3d::Zero();
  std::optional<Quaterniond> q_body_to_frame;  ///< empty: yaw unknown
  Vector3d velocity_frame_mps = Vector3d::Zero();
  Vector3d velocity_body_mps = Vector3d::Zero();  ///< unknown without yaw
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  Matrix6 pose_covariance = Matrix6::Zero();  ///< position, then a rotation about the frame's axes
  Vector3d orientation_variance_body_rad2 = Vector3d::Zero();
  Matrix3 velocity_covariance_frame = Matrix3::Zero();
  Matrix3 velocity_covariance_body = Matrix3::Zero();
};

/// Microseconds of a stamp, as the messages of autopilots have it.
constexpr std::uint64_t to_us(TimeNs time_ns) {
  return static_cast<std::uint64_t>(time_ns / 1000);
}

/// Converts a pose of the IMU to that of the base (REP-103: x forward, y left, z up), which is the body.
ExternalOdometry external_odometry(const FusedPose& pose, const ros2::Mount& mount, North north);

}  // namespace sonopose::autopilot
