#pragma once
/// \file
/// The ROS 2 topics of the beacons: opened for a new beacon, kept for its return, closed for others.

#include "process/beacon_admission.hpp"
#include "process/free_memory.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/log.hpp"
#include "ros2/relay/relayed_beacons.hpp"
#include "ros2/relay/transform_tree.hpp"

#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

/// Main thread only, because a listener must not create entities. Logs what it does.
class OpenTopics {
public:
  /// What it works on. All must outlive it.
  struct Context {
    RelayedBeacons& beacons;
    process::BeaconAdmission& admission;
    ros2::Node& node;
    const Output& output;
    dds::DataWriter<ros2::TFMessage>& tf;
    TransformTree& tree;
    process::Wakeup& wakeup;
    Log& log;
  };
  explicit OpenTopics(const Context& context) : context_(context) {}

  using Opened = std::vector<std::pair<BeaconAddress, RelayedBeacons::Publishers>>;
  /// Opens those of the beacons that were requested, until `stop`.
  Opened open_requested(const process::StopSignal& stop);

  /// Closes those of the beacons that are gone at `now` and not kept, and returns the gone beacons.
  std::vector<BeaconAddress> remove_gone(SteadyTime now);

private:
  RelayedBeacons::Publishers open(BeaconAddress address);
  void close_surplus();
  void close_removed();

  Context context_;
  process::FreeMemory free_memory_;
};

}  // namespace sonopose::ros2::relay
