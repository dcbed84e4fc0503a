#include "ros2/relay/relay.hpp"

#include "bridge/bridge_node.hpp"
#include "observation/beacon_observers.hpp"
#include "ros2/relay/beacon_publishers.hpp"
#include "ros2/relay/diagnostics.hpp"
#include "ros2/relay/parameter_server.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/graph.hpp>

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <thread>

namespace sonopose::ros2::relay {
namespace {

namespace topics = dds::topics;

constexpr TimeNs status_period_ns = 1'000'000'000;
constexpr TimeNs poll_period_ns = 20'000'000;
/// Harms no other process (ros2::layout_for).
constexpr auto layout_without_others = ros2::Distro::humble;

/// Throws std::invalid_argument if an input is an output of the relay.
void check_inputs(const RelayOptions& options) {
  for (const Input& input : options.inputs) {
    for (const Input& origin : options.inputs) {
      const std::string prefix = ros2::topic_prefix(options.output.beacon_namespace, origin.address);
      for (const char* const output : {"imu/data_raw", "imu/data", "pose", "fix"}) {
        if (options.names.topic(input.topic) != options.names.topic(prefix + output)) continue;
        throw std::invalid_argument(
            fmt::format("{} is the relay's own output, made from {}", text_of(input), text_of(origin)));
      }
    }
  }
}

/// A norm slightly different from 1 is a rounding error.
bool is_rotation(const Quaterniond& q) {
  return std::abs(q.squaredNorm() - 1) < 0.02;  // false for NaN
}

}  // namespace

class Relay::Impl {
public:
  explicit Impl(const RelayOptions& options);

  void run(const process::StopSignal& stop);

private:
  /// Passes the samples of one native topic to the publishers of their beacon.
  template <class T>
  class PublishingListener final : public process::CountingReaderListener<T> {
  public:
    explicit PublishingListener(Impl& relay)
        : process::CountingReaderListener<T>(relay.endpoints_), relay_(relay) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override {
      reader.try_take_each(
          [this](const T& sample, const dds::SampleInfo&) { relay_.on(dds::topics::from_idl(sample)); });
    }

  private:
    Impl& relay_;
  };

  /// Poses are published, and observed for diagnostics.
  class PoseListener final : public observation::ObservingListener<sonopose_FusedPose> {
  public:
    explicit PoseListener(Impl& relay)
        : ObservingListener(relay.observers_, relay.endpoints_), relay_(relay) {}

  private:
    void on_sample(const FusedPose& pose) noexcept override { relay_.on(pose); }

    Impl& relay_;
  };

  class TfListener final : public dds::DataReaderListener<ros2::TFMessage> {
  public:
    explicit TfListener(Impl& relay) : relay_(relay) {}
    void on_data_available(dds::DataReader<ros2::TFMessage>& reader) noexcept override {
      reader.try_take_each([this](const ros2::TFMessage& message, const dds::SampleInfo&) {
        for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
          relay_.on_transform(message.transforms._buffer[i]);
        }
      });
    }

  private:
    Impl& relay_;
  };

  /// A native topic: its listener and its reader.
  template <class T, class Listener>
  struct Subscription {
    template <class... Arguments>
    explicit Subscription(Arguments&... arguments) : listener(arguments...) {}
    Listener listener;
    dds::DataReader<T> reader;
  };
  template <class T>
  using PublishedTopic = Subscription<T, PublishingListener<T>>;
  template <class T>
  using ObservedTopic = Subscription<T, observation::ObservingListener<T>>;

  /// Samples, fixes, reports and poses.
  template <class Sample>
  void on(const Sample& sample) {
    if (BeaconPublishers* const publishers = find_or_request_publishers(sample.address))
      publishers->on(sample);
  }
  void on(const EffectiveSettings& settings);
  void on_transform(const ros2::TransformStamped& transform);

  /// Null if the publishers do not exist yet: the main thread creates them.
  BeaconPublishers* find_or_request_publishers(BeaconAddress address);
  BeaconPublishers* find_publishers(BeaconAddress address);
  template <class Action>
  void for_each_beacon(const Action& action);
  void create_new_publishers();
  void observe_graph();
  bool is_in_tree(BeaconAddress address);
  void publish_static_transforms();
  void publish_diagnostics();
  [[nodiscard]] ros2::Diagnostic own_diagnostic(std::size_t beacons) const;
  void check_transforms(const BeaconPublishers& publishers, ros2::Diagnostic& diagnostic) const;
  void serve(const process::StopSignal& stop, const std::atomic<bool>& failed);
  void bridge_while(const std::function<void()>& serve, std::atomic<bool>& failed);
  void serve_parameters(const std::stop_token& end, const process::StopSignal& stop);

  [[nodiscard]] const std::string& node_name() const { return options_.names.node().name; }

  RelayOptions options_;
  dds::DomainParticipant participant_;
  dds::qos::Provider qos_;
  ros2::Node node_;
  process::Wakeup wakeup_;  ///< of the main thread
  std::atomic<bool> graph_changed_ = true;
  ros2::GraphObserver graph_;
  ParameterServer parameters_;
  dds::DataWriter<ros2::DiagnosticArray> diagnostics_writer_;
  dds::DataWriter<ros2::TFMessage> tf_writer_;
  dds::DataWriter<ros2::TFMessage> static_tf_writer_;
  std::optional<BeaconAddress>
      tree_owner_;  ///< the beacon with transforms, if all beacons have the same frames
  bool reported_shared_frames_ = false;
  std::unique_ptr<Source> source_;  ///< null without inputs
  observation::BeaconObservers observers_;
  process::EndpointCounters endpoints_;
  std::map<BeaconAddress, observation::BeaconView> previous_views_;  ///< of the previous diagnostics

  std::mutex mutex_;  ///< guards the members below
  std::map<BeaconAddress, std::unique_ptr<BeaconPublishers>>
      publishers_;                                                 ///< null: to be created; never erased
  std::map<BeaconAddress, EffectiveSettings> effective_settings_;  ///< may arrive before any sample
  bool has_new_beacon_ = false;

  // Readers are last, so that they are destroyed first and no callback uses a destroyed member.
  TfListener tf_listener_{*this};
  dds::DataReader<ros2::TFMessage> tf_reader_;
  PublishedTopic<sonopose_ImuSample> imu_{*this};
  PublishedTopic<sonopose_UltrasonicFix> fix_{*this};
  Subscription<sonopose_FusedPose, PoseListener> pose_{*this};
  PublishedTopic<sonopose_FixReport> report_{*this};
  PublishedTopic<sonopose_EffectiveSettings> settings_{*this};
  ObservedTopic<sonopose_BeaconStatus> beacon_status_{observers_, endpoints_};
  ObservedTopic<sonopose_FusionStatus> fusion_status_{observers_, endpoints_};
};

Relay::Relay(const RelayOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Relay::~Relay() = default;

void Relay::run(const process::StopSignal& stop) {
  impl_->run(stop);
}

Relay::Impl::Impl(const RelayOptions& options)
    : options_(options),
      participant_(options.domain, ros2::participant_qos(options.enclave)),
      qos_(options.qos_file),
      node_(participant_, qos_, options.names, options.distro.value_or(layout_without_others)),
      graph_(participant_,
             [this] {
               graph_changed_ = true;
               wakeup_.wake();
             }),
      parameters_(node_, participant_, options.domain, options.qos_file),
      diagnostics_writer_(node_.make_writer<ros2::DiagnosticArray>("/diagnostics", "ros2::Diagnostics")),
      observers_(dds::deadline_of(qos_.datareader_qos(topics::pose.profile)).count()) {
  check_inputs(options);
  static_tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf_static", "ros2::TfStatic");
  if (options.output.tf != TfMode::off) tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf", "ros2::Tf");
  if (options.output.tf == TfMode::map_odom) {
    tf_reader_ = node_.make_reader<ros2::TFMessage>("/tf", "ros2::Tf", &tf_listener_);
  }
  node_.announce();
  const auto subscribe = [this](auto& subscription, const auto& topic) {
    subscription.reader = dds::topics::make_reader(participant_, qos_, topic, &subscription.listener);
  };
  subscribe(imu_, topics::imu);
  subscribe(fix_, topics::fix);
  subscribe(pose_, topics::pose);
  subscribe(report_, topics::report);
  subscribe(settings_, topics::settings);
  subscribe(beacon_status_, topics::beacon_status);
  subscribe(fusion_status_, topics::fusion_status);
}

BeaconPublishers* Relay::Impl::find_or_request_publishers(BeaconAddress address) {
  if (!options_.addresses.contains(address)) return nullptr;
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = publishers_.try_emplace(address);
  if (is_new) {
    has_new_beacon_ = true;
    wakeup_.wake();
  }
  return found->second.get();
}

BeaconPublishers* Relay::Impl::find_publishers(BeaconAddress address) {
  const std::lock_guard lock(mutex_);
  const auto found = publishers_.find(address);
  return found == publishers_.end() ? nullptr : found->second.get();
}

/// Calls `action` without the lock: publishers are never destroyed before the relay.
template <class Action>
void Relay::Impl::for_each_beacon(const Action& action) {
  std::vector<BeaconPublishers*> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [address, publishers] : publishers_) {
      if (publishers) all.push_back(publishers.get());
    }
  }
  for (BeaconPublishers* const publishers : all) action(*publishers);
}

void Relay::Impl::on(const EffectiveSettings& settings) {
  {
    const std::lock_guard lock(mutex_);
    effective_settings_[settings.address] = settings;
  }
  if (auto* const publishers = find_publishers(settings.address)) publishers->on(settings);
}

void Relay::Impl::on_transform(const ros2::TransformStamped& transform) {
  const auto time_ns = ros2::from_ros(transform.header.stamp);
  if (!time_ns) return;
  const auto& [x, y, z] = transform.transform.translation;
  const ros2::Quaternion& q = transform.transform.rotation;
  ros2::Transform base_in_odom{{x, y, z}, Quaterniond(q.w, q.x, q.y, q.z)};
  if (!base_in_odom.translation_m.allFinite() || !is_rotation(base_in_odom.rotation)) return;
  base_in_odom.rotation.normalize();
  for_each_beacon([&](BeaconPublishers& publishers) {
    const ros2::FrameNames& frames = publishers.frames();
    if (frames.odom != transform.header.frame_id || frames.base != transform.child_frame_id) return;
    publishers.on_odometry(*time_ns, base_in_odom);
  });
}

/// Main thread only, because a listener must not create entities.
void Relay::Impl::create_new_publishers() {
  std::vector<BeaconAddress> missing;
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(has_new_beacon_, false)) return;
    for (const auto& [address, publishers] : publishers_) {
      if (!publishers) missing.push_back(address);
    }
  }
  for (const BeaconAddress address : missing) {
    auto created = std::make_unique<BeaconPublishers>(node_, options_.output, address, tf_writer_,
                                                      is_in_tree(address), wakeup_);
    const std::lock_guard lock(mutex_);
    if (const auto known = effective_settings_.find(address); known != effective_settings_.end()) {
      created->on(known->second);
    }
    publishers_[address] = std::move(created);
  }
  publish_static_transforms();
}

/// With shared frames, transforms of two beacons would conflict, so only one beacon publishes them.
bool Relay::Impl::is_in_tree(BeaconAddress address) {
  const ros2::FrameNames& frames = options_.output.frames;
  if (!tree_owner_) tree_owner_ = options_.addresses.first().value_or(address);
  if (tree_owner_ == address || ros2::has_frames_per_beacon(frames, options_.output.tf == TfMode::map_odom)) {
    return true;
  }
  if (options_.output.tf != TfMode::off && !std::exchange(reported_shared_frames_, true)) {
    fmt::print(stderr,
               "sonopose-ros2: beacon {} has no transforms, because it has the same frames as beacon {}. Use "
               "different frames for each beacon (--base-frame hedge_{{address}}/base_link --imu-frame "
               "hedge_{{address}}/imu_link, and --odom-frame with --tf map_odom), or select one beacon "
               "(--addresses)\n",
               address, *tree_owner_);
  }
  return false;
}

/// One message with all transforms, because a late subscriber receives only the last message.
void Relay::Impl::publish_static_transforms() {
  const ros2::Transform mount{options_.output.mount.imu_in_base_m, options_.output.mount.q_imu_to_base};
  std::vector<ros2::TransformStamped> transforms;
  for_each_beacon([&](BeaconPublishers& publishers) {
    if (!publishers.is_in_tree()) return;
    transforms.push_back(
        ros2::transform(mount, clocks::host_now(), publishers.frames().base, publishers.frames().imu));
  });
  if (transforms.empty()) return;
  ros2::TFMessage message{};
  ros2::borrow_sequence(message.transforms, transforms);
  static_tf_writer_.try_write(message);
}

void Relay::Impl::publish_diagnostics() {
  const TimeNs now_ns = clocks::host_now();
  std::vector<ros2::Diagnostic> diagnostics;
  for (const observation::BeaconView& view : observers_.take_windows(now_ns)) {
    if (!options_.addresses.contains(view.address)) continue;
    observation::BeaconView& previous = previous_views_[view.address];
    diagnostics.push_back(diagnostic_of(node_name(), view, previous, now_ns));
    previous = view;
    if (const auto* const publishers = find_publishers(view.address)) {
      check_transforms(*publishers, diagnostics.back());
    }
  }
  diagnostics.push_back(own_diagnostic(diagnostics.size()));
  diagnostics_writer_.try_write(ros2::DiagnosticMessage(diagnostics, now_ns).message());
}

ros2::Diagnostic Relay::Impl::own_diagnostic(std::size_t beacons) const {
  ros2::Diagnostic own;
  own.name = node_name() + ": relay";
  own.level = beacons == 0 ? ros2::Level::stale : ros2::Level::ok;
  own.message = beacons == 0 ? "no beacon received" : fmt::format("{} beacons", beacons);
  own.values = {{"samples_lost", std::to_string(endpoints_.samples_lost)},
                {"samples_rejected", std::to_string(endpoints_.samples_rejected)},
                {"incompatible_qos", std::to_string(endpoints_.incompatible_qos)}};
  for (const Input& input : options_.inputs) {
    if (!source_ || input.kind != Input::Kind::imu) continue;
    own.values.emplace_back(fmt::format("beacon_{}_input_samples_lost", input.address),
                            std::to_string(source_->samples_lost(input.address)));
  }
  return own;
}

void Relay::Impl::check_transforms(const BeaconPublishers& publishers, ros2::Diagnostic& diagnostic) const {
  std::string problem;
  if (options_.output.tf != TfMode::off && !publishers.is_in_tree()) {
    problem = "no transforms: another beacon has the same frames";
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

/// Main thread only. Selects the layout of the node's announcement by the other processes.
void Relay::Impl::observe_graph() {
  if (!graph_changed_.exchange(false)) return;
  const ros2::Graph graph = graph_.look(clocks::steady_now());
  graph_changed_ = graph_changed_ || graph.is_undecided;
  if (options_.distro) return;
  const auto layout = ros2::layout_for(graph);
  if (!layout || !node_.use_layout(*layout)) return;
  fmt::print(stderr, "sonopose-ros2: announced as in {}, like the other ROS 2 processes\n",
             *layout == ros2::Distro::humble ? "Humble" : "Iron and later");
}

/// Runs until the stop, or until `failed`.
void Relay::Impl::serve(const process::StopSignal& stop, const std::atomic<bool>& failed) {
  SteadyTime next_status = clocks::steady_now() + status_period_ns;
  while (!failed && !stop.wait_until(next_status, wakeup_)) {
    create_new_publishers();
    for_each_beacon([this](BeaconPublishers& publishers) { publishers.create_magnetic_writer(node_); });
    observe_graph();
    node_.announce();
    if (clocks::steady_now() < next_status) continue;
    next_status = clocks::steady_now() + status_period_ns;
    publish_diagnostics();
    for_each_beacon([](BeaconPublishers& publishers) {
      publishers.publish_overdue_fixes();
      publishers.publish_path();
    });
  }
}

/// Runs on a separate thread, because it waits for replies of the fusion.
void Relay::Impl::serve_parameters(const std::stop_token& end, const process::StopSignal& stop) {
  while (!end.stop_requested() && !stop.wait_until(clocks::steady_now() + poll_period_ns)) {
    try {
      parameters_.serve();
    } catch (const dds::Error& error) {
      fmt::print(stderr, "sonopose-ros2: parameters: {}\n", error.what());
    }
  }
}

void Relay::Impl::run(const process::StopSignal& stop) {
  const std::jthread parameters([&](const std::stop_token& end) { serve_parameters(end, stop); });
  std::atomic<bool> failed = false;
  if (options_.inputs.empty()) return serve(stop, failed);
  bridge_while([&] { serve(stop, failed); }, failed);
}

/// Runs a bridge for the inputs on a separate thread while `serve` runs. Rethrows an exception of the bridge.
void Relay::Impl::bridge_while(const std::function<void()>& serve, std::atomic<bool>& failed) {
  const auto timeout_ns = [this](const auto& entry) {
    return std::min(status_period_ns * 10, dds::deadline_of(qos_.datareader_qos(entry.profile)).count());
  };
  source_ = make_source(node_, options_.inputs, {timeout_ns(topics::imu), timeout_ns(topics::fix)},
                        options_.output.frames.map);
  bridge::BridgeNode bridge({.domain = options_.domain, .qos_file = options_.qos_file, .record_folder = {}});
  process::StopSignal bridge_stop;
  std::exception_ptr failure;
  {
    const std::jthread bridging([&] {
      try {
        bridge.run(*source_, bridge_stop);
      } catch (...) {
        failure = std::current_exception();
        failed = true;
        wakeup_.wake();
      }
    });
    const std::unique_ptr<process::StopSignal, void (*)(process::StopSignal*)> stop_at_exit(
        &bridge_stop, [](process::StopSignal* signal) { signal->request(); });
    serve();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sonopose::ros2::relay
