#include "ros2/relay/peer_monitor.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

#include <utility>

namespace sonopose::ros2::relay {
namespace {

/// Periods in which missing processes are not reported; bridge and fusion are discovered faster.
constexpr int periods_to_find_others = 3;

}  // namespace

PeerMonitor::PeerMonitor(const RelayOptions& options, const dds::domain::DomainParticipant& participant,
                         ros2::Node& node, ParameterServer& parameters, std::function<void()> wake)
    : options_(options),
      node_(node),
      parameters_(parameters),
      domain_id_(participant.domain_id()),
      graph_(participant, [this, wake = std::move(wake)] {
        changed_ = true;
        wake();
      }) {}

void PeerMonitor::observe() {
  report_namesake();
  if (!changed_.exchange(false)) return;
  const ros2::Graph graph = graph_.observe(clocks::steady_now());
  if (graph.is_undecided) changed_ = true;
  select_layout(graph);
  offer_services(graph);
}

void PeerMonitor::select_layout(const ros2::Graph& graph) {
  if (options_.distro) return;
  const auto layout = ros2::layout_for(graph);
  if (!layout || !node_.use_layout(*layout)) return;
  logging::info(fmt::format("announced as in {}, like the other ROS 2 processes",
                            *layout == ros2::Distro::humble ? "Humble" : "Iron and later"));
}

/// Offers or withdraws the services. Fast DDS clients identify a reply by RTPS fields that Cyclone's C
/// interface does not set.
void PeerMonitor::offer_services(const ros2::Graph& graph) {
  const bool withdrawn = options_.services == ServicesMode::off ||
                         (options_.services == ServicesMode::automatic && graph.has_fast_dds);
  parameters_.offer_services(node_, !withdrawn);
  if (std::exchange(services_withdrawn_, withdrawn) == withdrawn || options_.services == ServicesMode::off) {
    return;
  }
  logging::info(withdrawn ? "parameter services withdrawn: a process uses Fast DDS, where `ros2 param` would "
                            "wait for them forever. Use sonopose-settings, or --services on"
                          : "parameter services offered: no process uses Fast DDS any more");
}

void PeerMonitor::report_namesake() {
  if (!node_.found_namesake() || std::exchange(has_namesake_, true)) return;
  logging::warning(fmt::format(
      "another process has a node {}: ROS 2 shows only one of them, and topics and parameters are mixed up. "
      "Use --name or --namespace, or __node in a launch file",
      ros2::full_name(options_.names.node())));
}

void PeerMonitor::check_processes(bool has_bridge, bool has_fusion) {
  if (++periods_ < periods_to_find_others) return;
  std::string missing = has_bridge ? "" : "no bridge";
  if (!has_fusion) missing += has_bridge ? "no fusion" : " and no fusion";
  if (std::exchange(missing_, missing) == missing) return;
  if (missing.empty()) return logging::info("bridge and fusion found");
  logging::warning(fmt::format(
      "{} in domain {}: start it, or use its domain (--domain, ROS_DOMAIN_ID), its network and its "
      "partition. sonopose-doctor shows the processes",
      missing, domain_id_));
}

void PeerMonitor::check_clock(const RosClock& clock) {
  const bool has_message = clock.has_message();
  if (!clock.is_waiting() || ++waiting_periods_ < periods_to_find_others || named_clock_ == has_message)
    return;
  named_clock_ = has_message;
  logging::warning(fmt::format(
      "no {} on /clock yet, though --use-sim-time follows it: until then messages without a stamp are not "
      "used, and /diagnostics has the time 0. {}, or leave the option out",
      has_message ? "time after 0" : "message",
      has_message ? "Start the simulation, which may be paused" : "Play the recording with --clock"));
}

}  // namespace sonopose::ros2::relay
