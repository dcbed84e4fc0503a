#include "bridge/bridge_node.hpp"
#include "ros2/relay/relay_impl.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <stop_token>
#include <thread>

namespace sonopose::ros2 {
namespace {

namespace topics = dds::topics;

constexpr TimeNs status_period_ns = 1'000'000'000;

/// Throws std::invalid_argument where the relay would be fed with what it tells of its own inputs.
void check_inputs(const Ros2RelayOptions& options) {
  for (const Ros2Input& input : options.inputs) {
    for (const Ros2Input& told : options.inputs) {
      const std::string prefix = ros2::topic_prefix(options.output.beacon_namespace, told.address);
      for (const char* const output : {"imu/data_raw", "imu/data", "pose", "fix"}) {
        if (options.names.topic(input.topic) != options.names.topic(prefix + output)) continue;
        throw std::invalid_argument(
            fmt::format("{} is the relay's own output, made from {}", text_of(input), text_of(told)));
      }
    }
  }
}

/// A little off the unit sphere is rounding; further off it is no rotation.
bool is_rotation(const Quaterniond& q) {
  return std::abs(q.squaredNorm() - 1) < 0.02;  // false for nan
}

}  // namespace

Ros2Relay::Impl::Impl(const Ros2RelayOptions& options)
    : options_(options),
      participant_(options.domain, ros2::participant_qos(options.enclave)),
      qos_(options.qos_file),
      node_(participant_, qos_, options.names, options.distro),
      parameters_(node_, participant_, options.domain, options.qos_file),
      diagnostics_writer_(node_.make_writer<ros2::DiagnosticArray>("/diagnostics", "ros2::Diagnostics")),
      watches_(dds::deadline_of(qos_.datareader_qos(topics::pose.profile)).count()) {
  check_inputs(options);
  static_tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf_static", "ros2::TfStatic");
  if (options.output.tf != TfMode::off) tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf", "ros2::Tf");
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

Ros2Beacon* Ros2Relay::Impl::find_outputs(BeaconAddress address) {
  const std::lock_guard lock(mutex_);
  const auto found = outputs_.find(address);
  return found == outputs_.end() ? nullptr : found->second.get();
}

void Ros2Relay::Impl::on(const EffectiveSettings& settings) {
  {
    const std::lock_guard lock(mutex_);
    settings_in_force_[settings.address] = settings;
  }
  if (auto* const outputs = find_outputs(settings.address)) outputs->on(settings);
}

void Ros2Relay::Impl::on_transform(const ros2::TransformStamped& transform) {
  const auto time_ns = ros2::from_ros(transform.header.stamp);
  if (!time_ns) return;
  const auto& [x, y, z] = transform.transform.translation;
  const ros2::Quaternion& q = transform.transform.rotation;
  ros2::Transform base_in_odom{{x, y, z}, Quaterniond(q.w, q.x, q.y, q.z)};
  if (!base_in_odom.translation_m.allFinite() || !is_rotation(base_in_odom.rotation)) return;
  base_in_odom.rotation.normalize();
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
    auto made =
        std::make_unique<Ros2Beacon>(node_, options_.output, address, tf_writer_, is_in_tree(address));
    const std::lock_guard lock(mutex_);
    if (const auto known = settings_in_force_.find(address); known != settings_in_force_.end()) {
      made->on(known->second);
    }
    outputs_[address] = std::move(made);
  }
  publish_static_transforms();
}

/// Two beacons that say where the same frame is would pull the robot to and fro.
bool Ros2Relay::Impl::is_in_tree(BeaconAddress address) {
  const ros2::FrameNames& frames = options_.output.frames;
  if (!tree_owner_) tree_owner_ = options_.addresses.first().value_or(address);
  if (tree_owner_ == address || ros2::tell_beacons_apart(frames, options_.output.tf == TfMode::map_odom)) {
    return true;
  }
  if (options_.output.tf != TfMode::off && !std::exchange(reported_of_tree_, true)) {
    fmt::print(
        stderr,
        "sonopose-ros2: beacon {} has no transforms, since its frames are beacon {}'s. Give each its own "
        "(--base-frame hedge_{{address}}/base_link --imu-frame hedge_{{address}}/imu_link, and "
        "--odom-frame with --tf map_odom), or choose one (--addresses)\n",
        address, *tree_owner_);
  }
  return false;
}

/// Until the stop, or until `failed`.
void Ros2Relay::Impl::serve(const process::StopSignal& stop, const std::atomic<bool>& failed) {
  constexpr TimeNs look_period_ns = 20'000'000;
  SteadyTime status_due = process::steady_now() + status_period_ns;
  while (!failed && !stop.wait_until(process::steady_now() + look_period_ns)) {
    make_new_outputs();
    for_each_output([this](Ros2Beacon& outputs) {
      outputs.make_magnetic(node_);
      outputs.publish_overdue_fixes();
    });
    node_.announce();
    if (process::steady_now() < status_due) continue;
    status_due = process::steady_now() + status_period_ns;
    publish_diagnostics();
    for_each_output([](Ros2Beacon& outputs) { outputs.publish_path(); });
  }
}

Ros2Relay::Ros2Relay(const Ros2RelayOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Ros2Relay::~Ros2Relay() = default;

void Ros2Relay::run(const process::StopSignal& stop) {
  impl_->run(stop);
}

/// On a thread of its own: it waits for the fusion's answers.
void Ros2Relay::Impl::serve_parameters(const std::stop_token& end, const process::StopSignal& stop) {
  constexpr TimeNs look_period_ns = 20'000'000;
  while (!end.stop_requested() && !stop.wait_until(process::steady_now() + look_period_ns)) {
    try {
      parameters_.serve();
    } catch (const dds::Error& error) {
      fmt::print(stderr, "sonopose-ros2: parameters: {}\n", error.what());
    }
  }
}

void Ros2Relay::Impl::run(const process::StopSignal& stop) {
  const std::jthread parameters([&](const std::stop_token& end) { serve_parameters(end, stop); });
  std::atomic<bool> failed = false;
  if (options_.inputs.empty()) return serve(stop, failed);
  feed_while([&] { serve(stop, failed); }, failed);
}

/// What comes in from ROS 2 is a bridge of its own, on a thread of its own, as long as `serve` runs. What
/// makes it unusable is thrown here.
void Ros2Relay::Impl::feed_while(const std::function<void()>& serve, std::atomic<bool>& failed) {
  const auto timeout_ns = [this](const auto& entry) {
    return std::min(status_period_ns * 10, dds::deadline_of(qos_.datareader_qos(entry.profile)).count());
  };
  source_ = make_ros2_source(node_, options_.inputs, {timeout_ns(topics::imu), timeout_ns(topics::fix)},
                             options_.output.frames.map);
  bridge::BridgeNode bridge({.domain = options_.domain, .qos_file = options_.qos_file, .record_folder = {}});
  process::StopSignal enough;
  std::exception_ptr failure;
  {
    const std::jthread feeding([&] {
      try {
        bridge.run(*source_, enough);
      } catch (...) {
        failure = std::current_exception();
        failed = true;
      }
    });
    const std::unique_ptr<process::StopSignal, void (*)(process::StopSignal*)> end(
        &enough, [](process::StopSignal* it) { it->request(); });
    serve();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sonopose::ros2
