#include "ros2/relay/input_frames.hpp"

#include <sonopose/ros2/messages/pose_input.hpp>

#include <utility>

namespace sonopose::ros2::relay {

InputFrames input_frames(const ros2::FrameNames& names, std::function<ros2::Mount(BeaconAddress)> mount,
                         const FixedFrames* tf) {
  InputFrames frames;
  frames.mount = std::move(mount);
  const auto find_in = [&names, tf](std::string ros2::FrameNames::*parent) {
    return [&names, tf, parent](BeaconAddress address,
                                const std::string& frame) -> std::optional<ros2::Transform> {
      const std::string in = ros2::for_beacon(names, address).*parent;
      const std::string name = frame.starts_with('/') ? frame.substr(1) : frame;
      if (name.empty() || name == in) return ros2::Transform{};
      return tf != nullptr ? tf->find(in, name) : std::nullopt;
    };
  };
  frames.in_map = find_in(&ros2::FrameNames::map);
  frames.in_base = [&names, mount = frames.mount, find = find_in(&ros2::FrameNames::base)](
                       BeaconAddress address, const std::string& frame) -> std::optional<ros2::Transform> {
    if (frame != ros2::for_beacon(names, address).imu) return find(address, frame);
    const ros2::Mount current = mount(address);
    return ros2::Transform{current.imu_in_base_m, current.q_imu_to_base};
  };
  return frames;
}

std::optional<Vector3d> tag_in_body(const Input& input, const InputFrames& frames) {
  if (!input.tag_base_m && input.tag_frame.empty()) return Vector3d(Vector3d::Zero());
  std::optional<Vector3d> in_base_m = input.tag_base_m;
  if (!in_base_m) {
    const auto transform = frames.in_base(input.address, input.tag_frame);
    if (!transform) return std::nullopt;
    in_base_m = transform->translation_m;
  }
  return ros2::point_in_body(*in_base_m, frames.mount(input.address));
}

}  // namespace sonopose::ros2::relay
