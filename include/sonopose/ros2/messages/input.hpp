#pragma once
/// \file
/// Conversions from ROS 2 messages to native types, for ROS 2 drivers of IMUs and positioning systems.

#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::ros2 {

// `received_ns`: time of reception, host clock. It is also the measurement time of a message with stamp 0,
// which means no stamp.

/// Converts sensor_msgs/Imu: angular velocity (rad/s) and specific force (m/s², +g on z at rest, REP-145) in
/// the axes of the sensor. The orientation is not used. Empty for a non-finite value or an invalid stamp.
std::optional<ImuSample> imu_sample(const Imu& imu, BeaconAddress address, TimeNs received_ns);

/// Converts a position in the map (m), with the measured delay from its stamp to `received_ns`. The
/// orientation is not used. A stamp after `received_ns`, of a clock slightly ahead, means no delay. Empty for
/// a non-finite position or an invalid stamp.
std::optional<UltrasonicFix> fix(const PointStamped& point, BeaconAddress address, TimeNs received_ns);
/// Overload with the covariance of the position, unless no variance is positive, which means unknown. Each
/// standard deviation is at least `min_fix_std_m`.
std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, BeaconAddress address,
                                 TimeNs received_ns);

/// Least standard deviation of a fix. A moving body is hardly ever located better: a stamp that is off by 10
/// ms gives 1 cm at 1 m/s. Drivers also leave single variances 0, or state the resolution of their output.
inline constexpr double min_fix_std_m = 0.01;

}  // namespace sonopose::ros2
