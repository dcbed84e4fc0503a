#pragma once
/// \file
/// ROS 2 message → native struct: how any IMU and any positioning system with a ROS 2 driver feeds the fusion.

#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <optional>

namespace sonopose::ros2 {

/// `received_ns` is when the message came, by the host's clock. A stamp of zero is none: then the message
/// counts as measured when it came.

/// sensor_msgs/Imu: angular velocity (rad/s) and specific force (m/s², +g on z at rest, REP-145) in the
/// sensor's axes; its orientation is not used. Empty for a value that is not finite, or a stamp that is none.
std::optional<ImuSample> imu_sample(const Imu& imu, BeaconAddress address, TimeNs received_ns);

/// A position in the map (m); its orientation and covariance are not used. Empty as above.
std::optional<UltrasonicFix> fix(const PointStamped& point, BeaconAddress address, TimeNs received_ns);
std::optional<UltrasonicFix> fix(const PoseWithCovarianceStamped& pose, BeaconAddress address,
                                 TimeNs received_ns);

}  // namespace sonopose::ros2
