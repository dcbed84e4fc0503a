#pragma once
/// \file
/// Selects the beacons in the transform tree, and publishes their static transforms.

#include "ros2/relay/relay.hpp"
#include "ros2/relay/ros_clock.hpp"

#include <optional>
#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

/// Membership in the tree. With shared frames, transforms of two beacons would conflict, so only one beacon
/// publishes them. Main thread only.
class TransformTree {
public:
  /// All arguments must outlive it. Throws dds::core::Exception.
  TransformTree(const RelayOptions& options, ros2::Node& node, const RosClock& clock);

  /// True if transforms of this beacon are published. Logs the first beacon that is not in the tree.
  bool admits(BeaconAddress address);

  /// The only beacon with transforms; empty before the first, or if each beacon has its own frames.
  [[nodiscard]] std::optional<BeaconAddress> owner() const;
  /// Makes this beacon the one with transforms, and logs it.
  void hand_over(BeaconAddress address);

  /// Publishes the mount of each beacon in the tree, unless the options leave it to others.
  void publish_mounts(const std::vector<std::pair<ros2::FrameNames, ros2::Mount>>& beacons);

private:
  [[nodiscard]] bool has_frames_per_beacon() const;

  const RelayOptions& options_;
  const RosClock& clock_;
  std::optional<BeaconAddress> owner_;  ///< only beacon with transforms, if all have the same frames
  bool reported_shared_frames_ = false;
  dds::pub::DataWriter<ros2::TFMessage> static_writer_ =
      dds::core::null;  ///< nil if the options leave the mount to others
};

}  // namespace sonopose::ros2::relay
