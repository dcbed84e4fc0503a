#include "ros2_relay_impl.hpp"
#include <sonopose/dds/conversions.hpp>
#include <sonopose/nodes/bridge_node.hpp>
#include <sonopose/nodes/host_clock.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <stop_token>
#include <thread>

namespace sonopose::nodes {
namespace {

namespace topics = dds::topics;

constexpr TimeNs second_ns = 1'000'000'000;

/// Throws std::invalid_argument where the relay would feed a beacon with what it tells of that beacon.
void check_inputs(const Ros2RelayOptions& options) {
  for (const Ros2Input& input : options.inputs) {
    const std::string prefix = ros2::for_beacon(options.output.beacon_namespace, input.address) + "/";
    for (const char* const output : {"imu/data_raw", "imu/data", "pose", "fix"}) {
      if (options.names.topic(input.topic) != options.names.topic(prefix + output)) continue;
      throw std::invalid_argument(fmt::format("{}={} is the relay's own output", input.topic, input.address));
    }
  }
}

}  // namespace

Ros2Relay::Impl::Impl(const Ros2RelayOptions& options)
    : options_(options),
      participant_(options.domain, ros2::participant_qos(options.enclave)),
      qos_(options.qos_file),
      node_(participant_, qos_, options.names, options.distro),
      parameters_(node_, participant_, options.domain, options.qos_file),
      diagnostics_writer_(node_.make_writer<ros2::DiagnosticArray>("/diagnostics", "ros2::Diagnostics")) {
  check_inputs(options);
  if (options.output.tf != TfMode::off) {
    tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf", "ros2::Tf");
    static_tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf_static", "ros2::TfStatic");
  }
  if (options.output.tf == TfMode::map_odom) {
    tf_reader_ = node_.make_reader<ros2::TFMessage>("/tf", "ros2::Tf", &tf_listener_);
  }
  node_.announce();
  imu_.reader = dds::make_reader(participant_, qos_, topics::imu, &imu_.listener);
  fix_.reader = dds::make_reader(participant_, qos_, topics::fix, &fix_.listener);
  pose_.reader = dds::make_reader(participant_, qos_, topics::pose, &pose_.listener);
  report_.reader = dds::make_reader(participant_, qos_, topics::report, &report_.listener);
  settings_.reader = dds::make_reader(participant_, qos_, topics::settings, &settings_.listener);
  beacon_status_.reader =
      dds::make_reader(participant_, qos_, topics::beacon_status, &beacon_status_.listener);
  fusion_status_.reader =
      dds::make_reader(participant_, qos_, topics::fusion_status, &fusion_status_.listener);
}

Ros2Beacon* Ros2Relay::Impl::outputs_of(BeaconAddress address) {
  if (!options_.addresses.contains(address)) return nullptr;
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = outputs_.try_emplace(address);
  if (is_new) has_new_ = true;
  return found->second.get();
}

void Ros2Relay::Impl::on(const EffectiveSettings& settings) {
  const std::lock_guard lock(mutex_);
  settings_in_force_[settings.address] = settings;
  if (const auto found = outputs_.find(settings.address); found != outputs_.end() && found->second) {
    found->second->on(settings);
  }
}

void Ros2Relay::Impl::on_transform(const ros2::TransformStamped& transform) {
  const auto time_ns = ros2::from_ros(transform.header.stamp);
  if (!time_ns) return;
  const auto& [x, y, z] = transform.transform.translation;
  const ros2::Quaternion& q = transform.transform.rotation;
  const ros2::Transform base_in_odom{{x, y, z}, Quaterniond(q.w, q.x, q.y, q.z)};
  std::vector<Ros2Beacon*> concerned;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [address, outputs] : outputs_) {
      if (outputs && outputs->frames().odom == transform.header.frame_id &&
          outputs->frames().base == transform.child_frame_id) {
        concerned.push_back(outputs.get());
      }
    }
  }
  for (Ros2Beacon* const outputs : concerned) outputs->on_odometry(*time_ns, base_in_odom);
}

/// On the main thread alone: a listener must not make entities.
void Ros2Relay::Impl::make_new_outputs() {
  std::vector<BeaconAddress> missing;
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(has_new_, false)) return;
    for (const auto& [address, outputs] : outputs_) {
      if (!outputs) missing.push_back(address);
    }
  }
  for (const BeaconAddress address : missing) {
    auto made = std::make_unique<Ros2Beacon>(node_, options_.output, address, transforms_for(address));
    const std::lock_guard lock(mutex_);
    if (const auto known = settings_in_force_.find(address); known != settings_in_force_.end()) {
      made->on(known->second);
    }
    outputs_[address] = std::move(made);
  }
  publish_static_transforms();
}

/// Two beacons that say where the same frame is would pull the robot to and fro.
dds::DataWriter<ros2::TFMessage>* Ros2Relay::Impl::transforms_for(BeaconAddress address) {
  if (options_.output.tf == TfMode::off) return nullptr;
  if (!tf_owner_) tf_owner_ = address;
  if (tf_owner_ == address || ros2::tell_beacons_apart(options_.output.frames)) return &tf_writer_;
  fmt::print(
      stderr,
      "sonopose-ros2: beacon {}: no transforms: its base would be beacon {}'s '{}'. Give each frames of "
      "its own: --base-frame hedge_{{address}}/base_link --imu-frame hedge_{{address}}/imu_link\n",
      address, *tf_owner_, options_.output.frames.base);
  return nullptr;
}

/// All in one message: who comes late gets the last one alone.
void Ros2Relay::Impl::publish_static_transforms() {
  if (options_.output.tf == TfMode::off) return;
  const ros2::Transform mount{options_.output.mount.imu_in_base_m, options_.output.mount.q_imu_to_base};
  std::vector<ros2::TransformStamped> transforms;
  for_each_output([&](Ros2Beacon& outputs) {
    if (!outputs.publishes_tf()) return;
    transforms.push_back(ros2::transform(mount, now_ns(), outputs.frames().base, outputs.frames().imu));
  });
  if (transforms.empty()) return;
  const auto length = static_cast<std::uint32_t>(transforms.size());
  static_tf_writer_.try_write({{length, length, transforms.data(), false}});
}

void Ros2Relay::Impl::publish_diagnostics() {
  std::vector<ros2::Diagnostic> diagnostics;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [address, watched] : watched_) {
      const BeaconView view = watched.watch.look(address, now_ns());
      diagnostics.push_back(diagnostic_of(node_name(), view, watched.before));
      watched.before = view;
      const auto outputs = outputs_.find(address);
      if (outputs != outputs_.end() && outputs->second)
        judge_transforms(*outputs->second, diagnostics.back());
    }
  }
  if (diagnostics.empty()) {
    diagnostics.push_back({ros2::Level::stale, node_name() + ": beacons", "no beacon was heard", "", {}});
  }
  diagnostics_writer_.try_write(ros2::DiagnosticMessage(diagnostics, now_ns()).message());
}

void Ros2Relay::Impl::judge_transforms(const Ros2Beacon& outputs, ros2::Diagnostic& diagnostic) const {
  std::string what;
  if (options_.output.tf != TfMode::off && !outputs.publishes_tf())
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

void Ros2Relay::Impl::serve(const StopSignal& stop) {
  constexpr TimeNs look_period_ns = 20'000'000;
  TimeNs tell_ns = steady_now_ns() + second_ns;
  while (!stop.wait_until(steady_now_ns() + look_period_ns)) {
    make_new_outputs();
    for_each_output([this](Ros2Beacon& outputs) { outputs.make_magnetic(node_); });
    node_.announce();
    if (steady_now_ns() < tell_ns) continue;
    tell_ns += second_ns;
    publish_diagnostics();
    for_each_output([](Ros2Beacon& outputs) { outputs.publish_path(); });
  }
}

Ros2Relay::Ros2Relay(const Ros2RelayOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Ros2Relay::~Ros2Relay() = default;

void Ros2Relay::run(const StopSignal& stop) {
  impl_->run(stop);
}

/// On a thread of its own: it waits for the fusion's answers.
void Ros2Relay::Impl::serve_parameters(const std::stop_token& end, const StopSignal& stop) {
  constexpr TimeNs look_period_ns = 20'000'000;
  while (!end.stop_requested() && !stop.wait_until(steady_now_ns() + look_period_ns)) {
    try {
      parameters_.serve();
    } catch (const dds::Error& error) {
      fmt::print(stderr, "sonopose-ros2: parameters: {}\n", error.what());
    }
  }
}

/// What comes in from ROS 2 is a bridge of its own, on a thread of its own.
void Ros2Relay::Impl::run(const StopSignal& stop) {
  const std::jthread parameters([&](const std::stop_token& end) { serve_parameters(end, stop); });
  if (options_.inputs.empty()) return serve(stop);
  const auto timeout_ns = [this](const auto& entry) {
    return std::min(second_ns * 10, dds::deadline_of(qos_.datareader_qos(entry.profile)).count());
  };
  const auto source =
      make_ros2_source(node_, options_.inputs, {timeout_ns(topics::imu), timeout_ns(topics::fix)});
  BridgeNode bridge({.domain = options_.domain, .qos_file = options_.qos_file, .record_folder = {}});
  std::thread feeding([&] { bridge.run(*source, stop); });
  serve(stop);
  feeding.join();
}

}  // namespace sonopose::nodes
