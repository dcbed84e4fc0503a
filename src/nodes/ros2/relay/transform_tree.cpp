#include "ros2/relay/transform_tree.hpp"

#include "logging/log.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/messages.hpp>

#include <fmt/format.h>

#include <utility>

namespace sonopose::ros2::relay {

TransformTree::TransformTree(const RelayOptions& options, ros2::Node& node, const RosClock& clock)
    : options_(options), clock_(clock) {
  if (options.output.publishes_mount()) {
    static_writer_ = node.make_writer<ros2::TFMessage>("/tf_static", "ros2::TfStatic");
  }
}

bool TransformTree::admits(BeaconAddress address) {
  const Output& output = options_.output;
  if (!owner_) owner_ = options_.addresses.first().value_or(address);
  if (owner_ == address || has_frames_per_beacon()) return true;
  if (output.tf != TfMode::off && !std::exchange(reported_shared_frames_, true)) {
    logging::warning(fmt::format(
        "beacon {} has no transforms, because it has the same frames as beacon {}. Use different frames for "
        "each beacon (--base-frame hedge_{{address}}/base_link --imu-frame hedge_{{address}}/imu_link, and "
        "--odom-frame with --tf map_odom), or select one beacon (--addresses)",
        address, *owner_));
  }
  return false;
}

std::optional<BeaconAddress> TransformTree::owner() const {
  return has_frames_per_beacon() ? std::nullopt : owner_;
}

void TransformTree::hand_over(BeaconAddress address) {
  logging::warning(fmt::format("beacon {} has the transforms now, because beacon {} is gone", address,
                               owner_.value_or(address)));
  owner_ = address;
}

bool TransformTree::has_frames_per_beacon() const {
  return ros2::has_frames_per_beacon(options_.output.frames, options_.output.tf == TfMode::map_odom);
}

void TransformTree::publish_mounts(const std::vector<std::pair<ros2::FrameNames, ros2::Mount>>& beacons) {
  if (static_writer_.is_nil() || beacons.empty()) return;
  std::vector<ros2::TransformStamped> transforms;
  transforms.reserve(beacons.size());
  for (const auto& [frames, mount] : beacons) {
    const ros2::Transform imu_in_base{mount.imu_in_base_m, mount.q_imu_to_base};
    transforms.push_back(ros2::transform(imu_in_base, clock_.now_ns(), frames.base, frames.imu));
  }
  // One message with all transforms, because a late subscriber receives only the last message.
  ros2::TFMessage message{};
  ros2::borrow_sequence(message.transforms, transforms);
  dds::ext::try_write(static_writer_, message);
}

}  // namespace sonopose::ros2::relay
