#include <sonopose/ros2/messages/static_transforms.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

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
    all_fit = !is_long(one.header.frame_id) && !is_long(one.child_frame_id) &&
              add(std::string(without_slash(one.header.frame_id)),
                  std::string(without_slash(one.child_frame_id)), *transform) &&
              all_fit;
  }
  return all_fit;
}

/// True up to rounding.
bool StaticTransforms::is_same(const Edge& a, const Edge& b) {
  constexpr double max_difference = 1e-6;
  const Transform& one = a.child_in_parent;
  const Transform& other = b.child_in_parent;
  return a.parent == b.parent && (one.translation_m - other.translation_m).norm() < max_difference &&
         one.rotation.angularDistance(other.rotation) < max_difference;
}

bool StaticTransforms::add(std::string parent, const std::string& child, const Transform& child_in_parent) {
  const auto known = edges_.find(child);
  if (known == edges_.end() && edges_.size() >= max_frames) return false;
  if (known != edges_.end() && !is_same(known->second, {parent, child_in_parent}) &&
      moved_.size() < max_moved) {
    moved_.insert(child);
  }
  edges_[child] = {std::move(parent), child_in_parent};
  return true;
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

std::vector<std::string> StaticTransforms::frames(std::size_t max_count) const {
  std::vector<std::string> names;
  for (auto edge = edges_.begin(); edge != edges_.end() && names.size() < max_count; ++edge) {
    names.push_back(edge->first);
  }
  return names;
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
