#pragma once
/// \file
/// The frames of one beacon in ROS 2's transform tree (REP-105), and the state of the base in them.
///
/// map ─(odom)─ base_link ─ imu_link: `map` is the world of the beacons, `imu_link` the body axes of the IMU
/// (right-handed, Z up, as in REP-103), `base_link` the robot on which the IMU is mounted.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sonopose::ros2 {

/// Names of frames; `{address}` is replaced by the beacon's address.
struct FrameNames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";
  std::string imu = "imu_link";
};

/// Removes a leading slash, which tf2 ignores.
std::string_view without_slash(std::string_view frame);

/// Replaces `{address}` in `pattern`.
std::string for_beacon(const std::string& pattern, BeaconAddress address);
FrameNames for_beacon(const FrameNames& patterns, BeaconAddress address);

/// An invalid frame name.
class FrameError : public std::invalid_argument {
public:
  FrameError(std::string frame, const std::string& name, const std::string& why);

  /// The frame: "map", "odom", "base" or "imu".
  const std::string& frame() const noexcept { return frame_; }

private:
  std::string frame_;
};

/// Throws FrameError for a name that is empty or begins with a slash, and for two frames with the same name
/// for any address.
void check(const FrameNames& patterns);

/// True if each beacon has different frames for base and IMU, and for `odom` if the relay publishes its
/// transform. The tree requires this because a frame has one parent.
bool has_frames_per_beacon(const FrameNames& patterns, bool moves_odom);

/// Pose of the IMU on the robot.
struct Mount {
  Vector3d imu_in_base_m = Vector3d::Zero();
  Quaterniond q_imu_to_base = Quaterniond::Identity();
};

/// Mount from x, y, z (m), then roll, pitch, yaw (deg): rotations about the fixed axes X, Y, Z of the base,
/// in this order (REP-103). Throws std::invalid_argument beyond 1000 m or 360 degrees and for NaN, with the
/// element, its value and the limit.
Mount mount_at(const std::array<double, 6>& pose);

/// Pose of a child frame in its parent frame.
struct Transform {
  Vector3d translation_m = Vector3d::Zero();
  Quaterniond rotation = Quaterniond::Identity();  ///< child axes → parent axes
};

/// Composition: the child of `outer` must be the parent of `inner`.
Transform operator*(const Transform& outer, const Transform& inner);
Transform inverse_of(const Transform& transform);

/// Motion of the base; the fused pose is that of the IMU.
struct BaseState {
  Vector3d position_map_m = Vector3d::Zero();
  Quaterniond q_base_to_map = Quaterniond::Identity();
  Vector3d velocity_base_mps = Vector3d::Zero();
  Vector3d angular_velocity_base_radps = Vector3d::Zero();
};

/// Motion of the base as a rigid body: v_base = v_imu − ω × r.
BaseState base_state(const FusedPose& pose, const Mount& mount);

}  // namespace sonopose::ros2
