#pragma once
/// \file
/// Publishes /diagnostics: one status of each beacon and one of the relay.

#include "observation/beacon_observers.hpp"
#include "process/endpoint_counters.hpp"
#include "ros2/relay/presence.hpp"
#include "ros2/relay/relay.hpp"
#include "ros2/relay/relayed_beacons.hpp"
#include "ros2/relay/ros_clock.hpp"
#include "ros2/relay/source.hpp"
#include <sonopose/ros2/messages/diagnostics.hpp>

#include <cstdint>
#include <map>
#include <string>

namespace sonopose::ros2::relay {

/// Main thread only.
class DiagnosticsPublisher {
public:
  using Beacons = std::map<BeaconAddress, RelayedBeacons::Publishers>;

  /// All arguments must outlive it. Throws dds::core::Exception.
  DiagnosticsPublisher(const RelayOptions& options, ros2::Node& node, const RosClock& clock,
                       observation::BeaconObservers& observers, const process::EndpointCounters& endpoints);

  /// Publishes all diagnostics. Call it once per second. `source`: null without inputs.
  void publish(const Beacons& beacons, const Source* source);

  [[nodiscard]] bool is_present(BeaconAddress address) const;

  /// True if a beacon has disappeared, or has not appeared since the start.
  [[nodiscard]] bool is_gone(BeaconAddress address) const;

  /// Forgets a beacon that is gone.
  void forget(BeaconAddress address) {
    previous_views_.erase(address);
    presences_.erase(address);
  }

private:
  [[nodiscard]] std::string node_name() const;
  ros2::Diagnostic own_diagnostic(std::size_t reported, const Beacons& beacons, const Source* source);
  void check_transforms(const BeaconPublishers& publishers, ros2::Diagnostic& diagnostic) const;

  const RelayOptions& options_;
  const RosClock& clock_;
  observation::BeaconObservers& observers_;
  const process::EndpointCounters& endpoints_;
  dds::pub::DataWriter<ros2::DiagnosticArray> writer_;
  SteadyTime started_;
  std::map<BeaconAddress, observation::BeaconView> previous_views_;  ///< views of the previous diagnostics
  std::map<BeaconAddress, Presence> presences_;
  std::uint64_t reported_imu_data_lost_ = 0;
};

}  // namespace sonopose::ros2::relay
