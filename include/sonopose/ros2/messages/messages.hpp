#pragma once
/// \file
/// Conversions from native types to ROS 2 messages: pure functions that do not allocate. A message borrows
/// the frame names, which must outlive it.

#include <sonopose/ros2/messages/covariance.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2 {

Header header_of(TimeNs stamp_ns, const std::string& frame_id);

/// The sample as measured, in the axes of the IMU, without orientation: orientation_covariance[0] is −1
/// (REP-145).
Imu raw_imu(const ImuSample& sample, TimeNs stamp_ns, const FrameNames& frames, const Noise& noise);

/// The sample with the fused orientation body → map, and without the gyro bias. `pose` is the pose at this
/// sample.
Imu fused_imu(const ImuSample& sample, const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames,
              const Noise& noise);

/// Magnetic field of the sample; empty if it has none.
std::optional<MagneticField> magnetic_field(const ImuSample& sample, TimeNs stamp_ns,
                                            const FrameNames& frames, const Noise& noise);

/// Pose of the base in the map, and its twist in the axes of the base (child_frame_id).
Odometry odometry(const FusedPose& pose, TimeNs stamp_ns, const FrameNames& frames, const Mount& mount,
                  const Noise& noise);

/// Pose of an odometry message.
PoseWithCovarianceStamped pose_of(const Odometry& odometry);

/// A position without orientation.
PoseWithCovarianceStamped position_as_pose(const Vector3d& position_map_m, const Covariance3& covariance,
                                           TimeNs stamp_ns, const FrameNames& frames);
PointStamped position_as_point(const Vector3d& position_map_m, TimeNs stamp_ns, const FrameNames& frames);

TransformStamped transform(const Transform& child_in_parent, TimeNs stamp_ns, const std::string& parent,
                           const std::string& child);

/// Pose of the base in the map, from an odometry message.
Transform base_in_map(const Odometry& odometry);

}  // namespace sonopose::ros2
