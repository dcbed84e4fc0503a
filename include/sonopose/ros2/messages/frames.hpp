#pragma once
/// \file
/// The frames of one beacon in ROS 2's tree (REP-105), and the base's state in them.
///
/// map ─(odom)─ base_link ─ imu_link: `map` is the beacons' world, `imu_link` the IMU's body axes (REP-103
/// as they are: right-handed, Z up), `base_link` the robot, to which the IMU is mounted.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <stdexcept>
#include <string>

namespace sonopose::ros2 {

/// Names of frames; `{address}` stands for the beacon's address.
struct FrameNames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";
  std::string imu = "imu_link";
};

/// `pattern` with the address filled in.
std::string for_beacon(const std::string& pattern, BeaconAddress address);
FrameNames for_beacon(const FrameNames& patterns, BeaconAddress address);

/// What is wrong with a frame's name.
class FrameError : public std::invalid_argument {
public:
  FrameError(std::string frame, const std::string& name, const std::string& why);

  /// Which it is: "map", "odom", "base" or "imu".
  const std::string& frame() const noexcept { return frame_; }

private:
  std::string frame_;
};

/// Throws FrameError for one that is empty or begins with a slash, and for two that are called the same, be
/// it for one beacon's address alone.
void check(const FrameNames& patterns);

/// Whether two beacons have frames of their own, as the tree needs it, since a frame has one parent: base and
/// IMU, and `odom` too where it is the relay that moves it.
bool tell_beacons_apart(const FrameNames& patterns, bool moves_odom);

/// Where the IMU sits on the robot.
struct Mount {
  Vector3d imu_in_base_m = Vector3d::Zero();
  Quaterniond q_imu_to_base = Quaterniond::Identity();
};

/// x, y, z (m), then roll, pitch, yaw (deg): turns about the base's fixed axes X, Y, Z, in this order
/// (REP-103). Throws std::invalid_argument, naming which of them, its value and the limit, for more than 1000
/// m or 360 degrees, and for what is no number.
Mount mount_at(const std::array<double, 6>& place);

/// Where a frame's origin stands in another one, and how it is turned.
struct Transform {
  Vector3d translation_m = Vector3d::Zero();
  Quaterniond rotation = Quaterniond::Identity();  ///< from the child's axes to the parent's
};

/// The child of `inner` in the parent of `outer`, whose child is the parent of `inner`.
Transform operator*(const Transform& outer, const Transform& inner);
Transform inverse_of(const Transform& transform);

/// The robot's motion: the fused pose, which is the IMU's, taken to the base.
struct BaseState {
  Vector3d position_map_m = Vector3d::Zero();
  Quaterniond q_base_to_map = Quaterniond::Identity();
  Vector3d velocity_base_mps = Vector3d::Zero();
  Vector3d angular_velocity_base_radps = Vector3d::Zero();
};

/// Of a rigid body: v_base = v_imu − ω × r.
BaseState base_state(const FusedPose& pose, const Mount& mount);

}  // namespace sonopose::ros2
