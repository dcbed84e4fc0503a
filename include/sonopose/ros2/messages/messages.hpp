#pragma once
/// \file
/// Native struct → ROS 2 message. Pure functions that allocate nothing: the texts of a message lead into the
/// frame names that it was made with, which must outlive it.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/covariance.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2 {

Header header_of(TimeNs stamp_ns, const std::string& frame_id);

/// As measured, in the IMU's axes, without orientation: orientation_covariance[0] is −1 (REP-145).
Imu raw_imu(const ImuSample& sample, TimeNs stamp_ns, const FrameNames& frames, const Noise& noise);

/// The same sample with the fused orientation body → map, and the gyro's bias taken off. `pose` is the one
/// made at this sample.
Imu fused_imu(const ImuSample& sample, const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames,
              const Noise& noise);

/// Empty where the sample has no magnetic field.
std::optional<MagneticField> magnetic_field(const ImuSample& sample, TimeNs stamp_ns,
                                            const FrameNames& frames, const Noise& noise);

/// The base in the map; its twist in the base's own axes (child_frame_id).
Odometry odometry(const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames, const Mount& mount,
                  const Noise& noise);

/// The pose of an odometry message alone.
PoseWithCovarianceStamped pose_of(const Odometry& odometry);

/// A position without orientation.
PoseWithCovarianceStamped position_as_pose(const Vector3d& position_map_m, const Covariance3& covariance,
                                           TimeNs stamp_ns, const FrameNames& frames);
PointStamped position_as_point(const Vector3d& position_map_m, TimeNs stamp_ns, const FrameNames& frames);

TransformStamped transform(const Transform& child_in_parent, TimeNs stamp_ns, const std::string& parent,
                           const std::string& child);

/// Where the base stands in the map according to an odometry message.
Transform base_in_map(const Odometry& odometry);

}  // namespace sonopose::ros2
