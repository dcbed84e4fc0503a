// What the relay tells once a second, and the transforms that do not move.

#include "ros2/relay/relay_impl.hpp"
#include <sonopose/ros2/messages/borrow.hpp>

#include <fmt/format.h>

namespace sonopose::ros2 {

/// All in one message: who comes late gets the last one alone.
void Ros2Relay::Impl::publish_static_transforms() {
  const ros2::Transform mount{options_.output.mount.imu_in_base_m, options_.output.mount.q_imu_to_base};
  std::vector<ros2::TransformStamped> transforms;
  for_each_output([&](Ros2Beacon& outputs) {
    if (!outputs.is_in_tree()) return;
    transforms.push_back(
        ros2::transform(mount, process::host_now(), outputs.frames().base, outputs.frames().imu));
  });
  if (transforms.empty()) return;
  ros2::TFMessage message{};
  ros2::lend(message.transforms, transforms);
  static_tf_writer_.try_write(message);
}

void Ros2Relay::Impl::publish_diagnostics() {
  const TimeNs now = process::host_now();
  const auto views = watches_.views(
      [now](observation::BeaconObserver& watch, BeaconAddress address) { return watch.look(address, now); });
  std::vector<ros2::Diagnostic> diagnostics;
  for (const observation::BeaconView& view : views) {
    if (!options_.addresses.contains(view.address)) continue;
    diagnostics.push_back(diagnostic_of(node_name(), view, told_[view.address], now));
    told_[view.address] = view;
    if (const auto* const outputs = find_outputs(view.address))
      judge_transforms(*outputs, diagnostics.back());
  }
  diagnostics.push_back(own_diagnostic(diagnostics.size()));
  diagnostics_writer_.try_write(ros2::DiagnosticMessage(diagnostics, now).message());
}

ros2::Diagnostic Ros2Relay::Impl::own_diagnostic(std::size_t beacons) const {
  ros2::Diagnostic own;
  own.name = node_name() + ": relay";
  own.level = beacons == 0 ? ros2::Level::stale : ros2::Level::ok;
  own.message = beacons == 0 ? "no beacon was heard" : fmt::format("{} beacons", beacons);
  own.values = {{"samples_lost", std::to_string(ends_.samples_lost)},
                {"samples_rejected", std::to_string(ends_.samples_rejected)},
                {"incompatible_qos", std::to_string(ends_.incompatible_qos)}};
  for (const Ros2Input& input : options_.inputs) {
    if (!source_ || input.kind != Ros2Input::Kind::imu) continue;
    own.values.emplace_back(fmt::format("beacon_{}_input_samples_lost", input.address),
                            std::to_string(source_->samples_lost(input.address)));
  }
  return own;
}

void Ros2Relay::Impl::judge_transforms(const Ros2Beacon& outputs, ros2::Diagnostic& diagnostic) const {
  std::string what;
  if (options_.output.tf != TfMode::off && !outputs.is_in_tree())
    what = "no transforms: its frames are taken";
  if (outputs.lacks_odometry()) {
    what = fmt::format("no transforms: /tf has no {} -> {}", outputs.frames().odom, outputs.frames().base);
  }
  if (what.empty()) return;
  if (diagnostic.level == ros2::Level::ok) {
    diagnostic.level = ros2::Level::warning;
    diagnostic.message = what;
  } else {
    diagnostic.message += "; " + what;
  }
}

}  // namespace sonopose::ros2
