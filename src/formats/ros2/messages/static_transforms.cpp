#include <sonopose/ros2/messages/static_transforms.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace sonopose::ros2 {

std::optional<Transform> transform_of(const TransformStamped& message) {
  const auto& [x, y, z] = message.transform.translation;
  const Quaternion& q = message.transform.rotation;
  Transform transform{{x, y, z}, Quaterniond(q.w, q.x, q.y, q.z)};
  const bool is_rotation = std::abs(transform.rotation.squaredNorm() - 1) < 0.02;  // false for NaN
  if (!transform.translation_m.allFinite() || !is_rotation) return std::nullopt;
  transform.rotation.normalize();
  return transform;
}

bool StaticTransforms::add(const TFMessage& message) {
  const auto is_long = [](const char* name) {
    return ::strnlen(name, max_name_length + 1) > max_name_length;
  };
  bool all_fit = true;
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const TransformStamped& one = message.transforms._buffer[i];
    const auto transform = transform_of(one);
    if (!transform) continue;
    const bool fits = !is_long(one.header.frame_id) && !is_long(one.child_frame_id) &&
                      (edges_.size() < max_frames || edges_.contains(one.child_frame_id));
    if (fits) edges_[one.child_frame_id] = {one.header.frame_id, *transform};
    all_fit = all_fit && fits;
  }
  return all_fit;
}

std::optional<Transform> StaticTransforms::find(const std::string& parent, const std::string& child) const {
  Transform found;
  std::string frame = child;
  // A path is not longer than the number of edges, unless invalid messages form a cycle.
  for (std::size_t steps = 0; frame != parent; ++steps) {
    const auto edge = edges_.find(frame);
    if (edge == edges_.end() || steps == edges_.size()) return std::nullopt;
    found = edge->second.child_in_parent * found;
    frame = edge->second.parent;
  }
  return found;
}

/// The frame without a parent above this one.
std::string StaticTransforms::root_of(std::string frame) const {
  auto edge = edges_.find(frame);
  for (std::size_t steps = 0; edge != edges_.end() && steps < edges_.size(); ++steps) {
    frame = edge->second.parent;
    edge = edges_.find(frame);
  }
  return frame;
}

std::optional<Transform> StaticTransforms::between(const std::string& in, const std::string& frame) const {
  const std::string root = root_of(in);
  const auto in_root = find(root, in);
  const auto frame_in_root = find(root, frame);
  if (!in_root || !frame_in_root) return std::nullopt;
  return inverse_of(*in_root) * *frame_in_root;
}

}  // namespace sonopose::ros2
