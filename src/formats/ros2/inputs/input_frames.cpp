#include "ros2/inputs/input_frames.hpp"

#include <sonopose/ros2/messages/pose_input.hpp>

#include <fmt/format.h>

#include <utility>

namespace sonopose::ros2 {

InputFrames input_frames(const FrameNames& names, std::function<std::optional<Mount>(BeaconAddress)> mount,
                         const FindFrame& tf) {
  InputFrames frames;
  frames.mount = std::move(mount);
  const auto find_in = [&names, &tf](std::string FrameNames::*parent) {
    return [&names, tf, parent](BeaconAddress address, const std::string& frame) -> std::optional<Transform> {
      const std::string in = for_beacon(names, address).*parent;
      const std::string name(without_slash(frame));
      if (name.empty() || name == in) return Transform{};
      return tf ? tf(in, name) : std::nullopt;
    };
  };
  frames.in_map = find_in(&FrameNames::map);
  frames.in_base = [&names, mount = frames.mount, find = find_in(&FrameNames::base)](
                       BeaconAddress address, const std::string& frame) -> std::optional<Transform> {
    if (without_slash(frame) != for_beacon(names, address).imu) return find(address, frame);
    const auto current = mount(address);
    if (!current) return std::nullopt;
    return Transform{current->imu_in_base_m, current->q_imu_to_base};
  };
  return frames;
}

std::optional<Vector3d> tag_in_body(const Input& input, const InputFrames& frames, std::string& unused) {
  if (!input.tag_base_m && input.tag_frame.empty()) return Vector3d(Vector3d::Zero());
  std::optional<Vector3d> in_base_m = input.tag_base_m;
  if (!in_base_m) {
    const auto transform = frames.in_base(input.address, input.tag_frame);
    if (!transform) {
      unused = fmt::format("/tf_static does not connect '{}' with the base", input.tag_frame);
      return std::nullopt;
    }
    in_base_m = transform->translation_m;
  }
  const auto mount = frames.mount(input.address);
  if (mount) return point_in_body(*in_base_m, *mount);
  unused = mount_unknown;
  return std::nullopt;
}

}  // namespace sonopose::ros2
