#pragma once
/// \file
/// Watches the other processes of the domain, and adapts the relay's node to them.

#include "ros2/relay/parameter_server.hpp"
#include "ros2/relay/relay.hpp"
#include "ros2/relay/ros_clock.hpp"
#include <sonopose/ros2/node/graph.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Main thread only.
class PeerMonitor {
public:
  /// `wake` is called on a thread of DDS when observe() has work, and must not block. Everything else must
  /// outlive it. Throws dds::core::Exception.
  PeerMonitor(const RelayOptions& options, const dds::domain::DomainParticipant& participant,
              ros2::Node& node, ParameterServer& parameters, std::function<void()> wake);

  /// Selects the layout of the node's announcement, offers or withdraws the services, and reports another
  /// node of the same name. The node must then announce the changes.
  void observe();

  /// Logs missing processes, and their later appearance. Call it once per second.
  void check_processes(bool has_bridge, bool has_fusion);

  /// Logs once that simulated time is missing or stays at 0. Call it once per second.
  void check_clock(const RosClock& clock);

private:
  void select_layout(const ros2::Graph& graph);
  void offer_services(const ros2::Graph& graph);
  void report_namesake();

  const RelayOptions& options_;
  ros2::Node& node_;
  ParameterServer& parameters_;
  std::uint32_t domain_id_;
  std::atomic<bool> changed_ = true;
  ros2::GraphObserver graph_;
  bool services_withdrawn_ = false;
  bool has_namesake_ = false;
  int periods_ = 0;                  ///< number of periods since the start
  std::string missing_;              ///< processes, as last logged
  int waiting_periods_ = 0;          ///< number of them without simulated time
  std::optional<bool> named_clock_;  ///< true if /clock had messages when it was last named
};

}  // namespace sonopose::ros2::relay
