#pragma once
/// \file
/// The fixed part of a transform tree, from the messages of /tf_static.

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Converts a message; empty unless the numbers are finite and the quaternion has the norm 1, apart from
/// rounding.
std::optional<Transform> transform_of(const TransformStamped& message);

class StaticTransforms {
public:
  static constexpr std::size_t max_frames = 4096;
  static constexpr std::size_t max_name_length = 1024;

  /// Adds valid transforms; the latest one of a child frame counts. Returns false if some did not fit: new
  /// child frames beyond `max_frames` and names beyond `max_name_length`.
  bool add(const TFMessage& message);

  /// Pose of `child` in `parent`, over any number of frames in between; empty if they are not connected.
  std::optional<Transform> find(const std::string& parent, const std::string& child) const;

  /// Pose of `frame` in another one of the same tree, in whatever direction; empty if they are not connected.
  std::optional<Transform> between(const std::string& in, const std::string& frame) const;

  /// Child frames, at most `max_count` of them.
  std::vector<std::string> frames(std::size_t max_count) const;

  /// Child frames whose transform has changed, at most `max_moved` of them.
  const std::set<std::string>& moved() const { return moved_; }

private:
  static constexpr std::size_t max_moved = 8;

  struct Edge {
    std::string parent;
    Transform child_in_parent;
  };
  static bool is_same(const Edge& a, const Edge& b);
  bool add(std::string parent, const std::string& child, const Transform& child_in_parent);
  std::string root_of(std::string frame) const;

  std::map<std::string, Edge> edges_;  ///< edges by child frame
  std::set<std::string> moved_;
};

}  // namespace sonopose::ros2
