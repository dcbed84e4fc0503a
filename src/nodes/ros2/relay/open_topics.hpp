#pragma once
/// \file
/// Opens ROS 2 topics for a new beacon, keeps them for its return, and closes them for other beacons.

#include "presence/beacon_admission.hpp"
#include "process/free_memory.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/relayed_beacons.hpp"
#include "ros2/relay/transform_tree.hpp"

#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

/// Main thread only, because a listener must not create entities. Logs its actions.
class OpenTopics {
public:
  /// Its collaborators, which must outlive it.
  struct Context {
    RelayedBeacons& beacons;
    presence::BeaconAdmission& admission;
    ros2::Node& node;
    const Output& output;
    dds::pub::DataWriter<ros2::TFMessage>& tf;
    TransformTree& tree;
    process::Wakeup& wakeup;
  };
  explicit OpenTopics(const Context& context) : context_(context) {}

  using Opened = std::vector<std::pair<BeaconAddress, RelayedBeacons::Publishers>>;
  /// Opens the topics of requested beacons, until `stop`.
  Opened open_requested(const process::StopSignal& stop);

  /// Closes the topics of beacons that are gone at `now` and not kept. Returns the gone beacons.
  std::vector<BeaconAddress> remove_gone(SteadyTime now);

private:
  RelayedBeacons::Publishers open(BeaconAddress address);
  void close_surplus();
  void close_removed();

  Context context_;
  process::FreeMemory free_memory_;
};

}  // namespace sonopose::ros2::relay
