#pragma once
/// \file
/// Which beacons are in the transform tree, and their static transforms.

#include "ros2/relay/log.hpp"
#include "ros2/relay/relay.hpp"

#include <optional>
#include <vector>

namespace sonopose::ros2::relay {

/// With shared frames, transforms of two beacons would conflict, so only one beacon publishes them. Main
/// thread only.
class TransformTree {
public:
  /// `options`, `node` and `log` must outlive it. Throws dds::Error.
  TransformTree(const RelayOptions& options, ros2::Node& node, Log& log);

  /// Whether to publish transforms of this beacon. Logs the first one that is not in the tree.
  bool admits(BeaconAddress address);

  /// The only beacon with transforms; empty before the first one, and if each has frames of its own.
  [[nodiscard]] std::optional<BeaconAddress> only_beacon() const;
  void admit_only(BeaconAddress address) { owner_ = address; }

  /// Publishes the mount of each beacon in the tree, unless the options leave it to others.
  void publish_mounts(const std::vector<ros2::FrameNames>& beacons, TimeNs stamp_ns);

private:
  [[nodiscard]] bool has_frames_per_beacon() const;

  const RelayOptions& options_;
  Log& log_;
  std::optional<BeaconAddress> owner_;  ///< the only beacon with transforms, if all have the same frames
  bool reported_shared_frames_ = false;
  dds::DataWriter<ros2::TFMessage> static_writer_;  ///< nil if the options leave the mount to others
};

}  // namespace sonopose::ros2::relay
