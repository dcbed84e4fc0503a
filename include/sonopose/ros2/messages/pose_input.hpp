#pragma once
/// \file
/// Conversions of orientations and poses from ROS 2 to native headings and fixes.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <numbers>
#include <optional>

namespace sonopose::ros2 {

/// Greatest standard deviation of a heading that says anything.
inline constexpr double max_heading_std_rad = std::numbers::pi / 3.0;

/// Frames of a pose: that in which it is stated, and that of the robot whose pose it is.
struct PoseFrames {
  Transform stated_in_map;
  Transform measured_in_base;
  Mount mount;  ///< place of the IMU on the base
};

/// Place of a point of the base in body axes, seen from the IMU.
Vector3d point_in_body(const Vector3d& point_base_m, const Mount& mount);

// Any message with an orientation as the most general one, which borrows the names.

PoseWithCovarianceStamped as_pose(const Odometry& odometry);
/// Overload without a covariance.
PoseWithCovarianceStamped as_pose(const PoseStamped& pose);
/// Overload without a position. Empty if the first covariance is −1: no orientation (REP-145).
std::optional<PoseWithCovarianceStamped> as_pose(const Imu& imu);
/// Overload of a yaw of the base in the map in degrees, counter-clockwise from x, without a stamp.
PoseWithCovarianceStamped as_pose(const Float64& yaw_deg);

/// A heading, or why there is none.
struct ReceivedHeading {
  std::optional<PairHeading> heading;
  const char* fault = nullptr;  ///< reason why it is not used, or why its standard deviation is unknown
};

/// Converts an orientation to the direction of the body's x axis in the map (REP-103). Its standard deviation
/// is unknown without any variance, and if the variance of yaw is not finite or not positive.
/// `received_ns`: time of reception; the time of measurement of a message without a stamp.
ReceivedHeading heading(const PoseWithCovarianceStamped& pose, const PoseFrames& frames,
                        BeaconAddress address, TimeNs received_ns);

/// Converts a position like `fix`, to the map and with its place on the body.
std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, const PoseFrames& frames,
                                 BeaconAddress address, TimeNs received_ns);

}  // namespace sonopose::ros2
