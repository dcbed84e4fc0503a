#include "ros2/relay/diagnostics_publisher.hpp"

#include "clocks/clocks.hpp"
#include "ros2/relay/diagnostics.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

DiagnosticsPublisher::DiagnosticsPublisher(const RelayOptions& options, ros2::Node& node,
                                           const RosClock& clock, observation::BeaconObservers& observers,
                                           const process::EndpointCounters& endpoints)
    : options_(options),
      clock_(clock),
      observers_(observers),
      endpoints_(endpoints),
      writer_(node.make_writer<ros2::DiagnosticArray>("/diagnostics", "ros2::Diagnostics")),
      started_(clocks::steady_now()) {}

/// The node's name after its namespace: "sonopose", "robot/sonopose".
std::string DiagnosticsPublisher::node_name() const {
  return ros2::full_name(options_.names.node()).substr(1);
}

bool DiagnosticsPublisher::is_present(BeaconAddress address) const {
  const auto found = presences_.find(address);
  return found != presences_.end() && found->second.state(clocks::steady_now()) == Presence::State::present;
}

bool DiagnosticsPublisher::is_gone(BeaconAddress address) const {
  const SteadyTime now = clocks::steady_now();
  const auto found = presences_.find(address);
  return found == presences_.end() ? now - started_ > options_.presence.gone_after_ns
                                   : found->second.state(now) == Presence::State::gone;
}

void DiagnosticsPublisher::publish(const Beacons& beacons, const Source* source) {
  const TimeNs now_ns = clocks::host_now();
  std::vector<ros2::Diagnostic> diagnostics;
  for (const observation::BeaconView& view : observers_.take_windows(now_ns)) {
    if (!options_.addresses.contains(view.address)) continue;
    const SteadyTime now = clocks::steady_now();
    Presence& presence = presences_.try_emplace(view.address, options_.presence, now).first->second;
    presence.update(view, has_bridge(view, now_ns), now);
    observation::BeaconView& previous = previous_views_[view.address];
    if (presence.state(now) == Presence::State::gone) {
      previous = view;
      continue;
    }
    diagnostics.push_back(diagnostic_of(node_name(), view, previous, now_ns));
    previous = view;
    if (const auto found = beacons.find(view.address); found != beacons.end()) {
      check_transforms(*found->second, diagnostics.back());
    }
    if (presence.state(now) == Presence::State::stale) {
      ros2::Diagnostic& latest = diagnostics.back();
      const std::string silent = fmt::format("no samples for {:.0f} s", presence.silent_s(now));
      latest.message = latest.level == ros2::Level::ok ? silent : silent + "; " + latest.message;
      latest.level = ros2::Level::stale;
    }
  }
  diagnostics.push_back(own_diagnostic(diagnostics.size(), beacons, source));
  dds::ext::try_write(writer_, ros2::DiagnosticMessage(diagnostics, clock_.now_ns()).message());
}

ros2::Diagnostic DiagnosticsPublisher::own_diagnostic(std::size_t reported, const Beacons& beacons,
                                                      const Source* source) {
  std::uint64_t imu_data_lost = 0;
  for (const auto& [address, publishers] : beacons) imu_data_lost += publishers->imu_data_lost();
  ros2::Diagnostic own;
  own.name = node_name() + ": relay";
  own.level = reported == 0 ? ros2::Level::stale : ros2::Level::ok;
  own.message = reported == 0 ? "no beacon received" : text::count_text(reported, "beacon");
  own.values = {{"samples_lost", std::to_string(endpoints_.samples_lost)},
                {"samples_rejected", std::to_string(endpoints_.samples_rejected)},
                {"incompatible_qos", std::to_string(endpoints_.incompatible_qos)},
                {"imu_data_lost", std::to_string(imu_data_lost)}};
  if (clock_.now_ns() == 0) {
    own.level = ros2::Level::warning;
    own.message += "; /clock, the time of ROS 2 with use_sim_time, has not been received";
  }
  if (imu_data_lost > std::exchange(reported_imu_data_lost_, imu_data_lost)) {
    own.level = ros2::Level::warning;
    own.message += fmt::format("; {} of imu/data lost, whose IMU samples did not arrive",
                               text::count_text(imu_data_lost, "message"));
  }
  for (const Input& input : options_.inputs) {
    if (source == nullptr || input.kind != Input::Kind::imu) continue;
    own.values.emplace_back(fmt::format("beacon_{}_input_samples_lost", input.address),
                            std::to_string(source->samples_lost(input.address)));
  }
  return own;
}

void DiagnosticsPublisher::check_transforms(const BeaconPublishers& publishers,
                                            ros2::Diagnostic& diagnostic) const {
  std::string problem;
  if (options_.output.tf != TfMode::off && !publishers.is_in_tree()) {
    problem = "no transforms: another beacon has the same frames";
  }
  if (!publishers.has_mount()) {
    problem = fmt::format("no poses: /tf_static has no {} -> {}", publishers.frames().base,
                          publishers.frames().imu);
  }
  if (publishers.lacks_odometry()) {
    problem =
        fmt::format("no transforms: /tf has no {} -> {}", publishers.frames().odom, publishers.frames().base);
  }
  if (problem.empty()) return;
  if (diagnostic.level == ros2::Level::ok) {
    diagnostic.level = ros2::Level::warning;
    diagnostic.message = problem;
  } else {
    diagnostic.message += "; " + problem;
  }
}

}  // namespace sonopose::ros2::relay
