#include <sonopose/ros2/frames.hpp>

namespace sonopose::ros2 {
namespace {

const std::string placeholder = "{address}";

}  // namespace

std::string for_beacon(const std::string& pattern, BeaconAddress address) {
  std::string name = pattern;
  const std::string number = std::to_string(address);
  for (std::size_t at = name.find(placeholder); at != std::string::npos; at = name.find(placeholder)) {
    name.replace(at, placeholder.size(), number);
  }
  return name;
}

FrameNames for_beacon(const FrameNames& patterns, BeaconAddress address) {
  return {for_beacon(patterns.map, address), for_beacon(patterns.odom, address),
          for_beacon(patterns.base, address), for_beacon(patterns.imu, address)};
}

bool tell_beacons_apart(const FrameNames& patterns) {
  return patterns.base.find(placeholder) != std::string::npos &&
         patterns.imu.find(placeholder) != std::string::npos;
}

Transform operator*(const Transform& outer, const Transform& inner) {
  return {outer.translation_m + outer.rotation * inner.translation_m, outer.rotation * inner.rotation};
}

Transform inverse_of(const Transform& transform) {
  const Quaterniond back = transform.rotation.conjugate();
  return {-(back * transform.translation_m), back};
}

BaseState base_state(const FusedPose& pose, const Mount& mount) {
  BaseState base;
  base.q_base_to_map = pose.q_body_to_world * mount.q_imu_to_base.conjugate();
  base.position_map_m = pose.position_world_m - base.q_base_to_map * mount.imu_in_base_m;
  base.angular_velocity_base_radps = mount.q_imu_to_base * pose.angular_velocity_body_radps;
  base.velocity_base_mps = base.q_base_to_map.conjugate() * pose.velocity_world_mps -
                           base.angular_velocity_base_radps.cross(mount.imu_in_base_m);
  return base;
}

}  // namespace sonopose::ros2
