#include "ros2/relay/relay.hpp"

#include "bridge/bridge_node.hpp"
#include "observation/beacon_observers.hpp"
#include "ros2/relay/beacon_publishers.hpp"
#include "ros2/relay/diagnostics.hpp"
#include "ros2/relay/log.hpp"
#include "ros2/relay/mount_finder.hpp"
#include "ros2/relay/parameter_server.hpp"
#include "ros2/relay/presence.hpp"
#include "ros2/relay/ros_clock.hpp"
#include "ros2/relay/surroundings.hpp"
#include "ros2/relay/transform_tree.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
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

/// A killed relay disappears from the graph after this time.
constexpr std::chrono::seconds lease{4};

RelayOptions with_lease(RelayOptions options) {
  options.domain.lease = lease;
  return options;
}

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

  template <class T, class Listener>
  static bool has_writer(Subscription<T, Listener>& subscription) {
    return subscription.reader.subscription_matched_status().current_count > 0;
  }

  /// Samples, fixes, reports, poses and estimates.
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
  void replace_tree_owner();
  void publish_mounts();
  void publish_diagnostics();
  [[nodiscard]] ros2::Diagnostic own_diagnostic(std::size_t beacons);
  void check_transforms(const BeaconPublishers& publishers, ros2::Diagnostic& diagnostic) const;
  void serve(const process::StopSignal& stop, const std::atomic<bool>& failed);
  void bridge_while(const std::function<void()>& serve, std::atomic<bool>& failed);
  void serve_parameters(const std::stop_token& end, const process::StopSignal& stop);

  [[nodiscard]] const std::string& node_name() const { return options_.names.node().name; }

  RelayOptions options_;
  Log log_;
  dds::DomainParticipant participant_;
  dds::qos::Provider qos_;
  ros2::Node node_;
  RosClock clock_;
  process::Wakeup wakeup_;  ///< of the main thread
  process::Wakeup parameters_wakeup_;
  ParameterServer parameters_;
  Surroundings surroundings_;
  dds::DataWriter<ros2::DiagnosticArray> diagnostics_writer_;
  dds::DataWriter<ros2::TFMessage> tf_writer_;
  std::uint64_t reported_imu_data_lost_ = 0;
  TransformTree tree_;
  std::unique_ptr<Source> source_;  ///< null without inputs
  observation::BeaconObservers observers_;
  process::EndpointCounters endpoints_;
  std::map<BeaconAddress, observation::BeaconView> previous_views_;  ///< of the previous diagnostics
  std::map<BeaconAddress, Presence> presences_;
  SteadyTime started_ = clocks::steady_now();

  std::mutex mutex_;  ///< guards the members below
  std::map<BeaconAddress, std::unique_ptr<BeaconPublishers>>
      publishers_;                                                 ///< null: to be created; never erased
  std::map<BeaconAddress, EffectiveSettings> effective_settings_;  ///< may arrive before any sample
  bool has_new_beacon_ = false;

  // Readers are last, so that they are destroyed first and no callback uses a destroyed member.
  TfListener tf_listener_{*this};
  dds::DataReader<ros2::TFMessage> tf_reader_;
  std::unique_ptr<MountFinder> mount_finder_;  ///< null if the mount is known
  PublishedTopic<sonopose_ImuSample> imu_{*this};
  PublishedTopic<sonopose_UltrasonicFix> fix_{*this};
  Subscription<sonopose_FusedPose, PoseListener> pose_{*this};
  PublishedTopic<sonopose_FixReport> report_{*this};
  PublishedTopic<sonopose_EffectiveSettings> settings_{*this};
  PublishedTopic<sonopose_Estimate> estimate_{*this};
  ObservedTopic<sonopose_BeaconStatus> beacon_status_{observers_, endpoints_};
  ObservedTopic<sonopose_FusionStatus> fusion_status_{observers_, endpoints_};
};

Relay::Relay(const RelayOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Relay::~Relay() = default;

void Relay::run(const process::StopSignal& stop) {
  impl_->run(stop);
}

Relay::Impl::Impl(const RelayOptions& options)
    : options_(with_lease(options)),
      log_(options.log_level),
      participant_(options_.domain, ros2::participant_qos(options.enclave)),
      qos_(options.qos_file),
      node_(participant_, qos_, options.names, options.distro.value_or(ros2::layout_without_others)),
      clock_(node_, options.use_sim_time),
      parameters_(node_, participant_,
                  {.domain = options_.domain,
                   .qos_file = options.qos_file,
                   .startup_settings = options.startup_settings},
                  log_, [this] { parameters_wakeup_.wake(); }),
      surroundings_(options_, participant_, node_, parameters_, log_, [this] { wakeup_.wake(); }),
      diagnostics_writer_(node_.make_writer<ros2::DiagnosticArray>("/diagnostics", "ros2::Diagnostics")),
      tree_(options_, node_, log_),
      observers_(dds::deadline_of(qos_.datareader_qos(topics::pose.profile)).count()) {
  check_inputs(options);
  if (options.rosout) log_.publish_as(node_);
  if (options.output.tf != TfMode::off) tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf", "ros2::Tf");
  if (options.output.tf == TfMode::map_odom) {
    tf_reader_ = node_.make_reader<ros2::TFMessage>("/tf", "ros2::Tf", &tf_listener_);
  }
  if (options.output.mount_from_tf) {
    mount_finder_ = std::make_unique<MountFinder>(node_, log_, [this] { wakeup_.wake(); });
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
  subscribe(estimate_, topics::estimate);
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
  const auto base_in_odom = ros2::transform_of(transform);
  if (!base_in_odom) return;
  for_each_beacon([&](BeaconPublishers& publishers) {
    const ros2::FrameNames& frames = publishers.frames();
    if (frames.odom != transform.header.frame_id || frames.base != transform.child_frame_id) return;
    publishers.on_odometry(*time_ns, *base_in_odom);
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
                                                      tree_.admits(address), wakeup_);
    const std::lock_guard lock(mutex_);
    if (const auto known = effective_settings_.find(address); known != effective_settings_.end()) {
      created->on(known->second);
    }
    publishers_[address] = std::move(created);
  }
  publish_mounts();
}

/// A beacon with the same frames takes over the transforms of one that is gone, or that has not appeared.
void Relay::Impl::replace_tree_owner() {
  const SteadyTime now = clocks::steady_now();
  const auto is_gone = [&](BeaconAddress address) {
    const auto found = presences_.find(address);
    if (found == presences_.end()) return now - started_ > Presence::gone_after_ns;
    return found->second.state(now) == Presence::State::gone;
  };
  const auto owner = tree_.only_beacon();
  if (!owner || !is_gone(*owner)) return;
  const auto next = std::find_if(presences_.begin(), presences_.end(), [&](const auto& entry) {
    return entry.second.state(now) == Presence::State::present && find_publishers(entry.first) != nullptr;
  });
  if (next == presences_.end()) return;
  log_.warning(
      fmt::format("beacon {} has the transforms now, because beacon {} is gone", next->first, *owner));
  if (auto* const before = find_publishers(*owner)) before->set_in_tree(false);
  tree_.admit_only(next->first);
  find_publishers(next->first)->set_in_tree(true);
  publish_mounts();
}

void Relay::Impl::publish_mounts() {
  std::vector<ros2::FrameNames> in_tree;
  for_each_beacon([&](const BeaconPublishers& publishers) {
    if (publishers.is_in_tree()) in_tree.push_back(publishers.frames());
  });
  tree_.publish_mounts(in_tree, clock_.now_ns());
}

void Relay::Impl::publish_diagnostics() {
  const TimeNs now_ns = clocks::host_now();
  std::vector<ros2::Diagnostic> diagnostics;
  for (const observation::BeaconView& view : observers_.take_windows(now_ns)) {
    if (!options_.addresses.contains(view.address)) continue;
    const SteadyTime now = clocks::steady_now();
    Presence& presence = presences_.try_emplace(view.address, now).first->second;
    presence.update(view, has_bridge(view, now_ns), now);
    observation::BeaconView& previous = previous_views_[view.address];
    if (presence.state(now) == Presence::State::gone) {
      previous = view;
      continue;
    }
    diagnostics.push_back(diagnostic_of(node_name(), view, previous, now_ns));
    previous = view;
    if (const auto* const publishers = find_publishers(view.address)) {
      check_transforms(*publishers, diagnostics.back());
    }
    if (presence.state(now) == Presence::State::stale) {
      diagnostics.back().level = ros2::Level::stale;
      diagnostics.back().message = fmt::format("no samples for {:.0f} s", presence.silent_s(now));
    }
  }
  diagnostics.push_back(own_diagnostic(diagnostics.size()));
  diagnostics_writer_.try_write(ros2::DiagnosticMessage(diagnostics, clock_.now_ns()).message());
}

ros2::Diagnostic Relay::Impl::own_diagnostic(std::size_t beacons) {
  std::uint64_t imu_data_lost = 0;
  for_each_beacon([&](const BeaconPublishers& publishers) { imu_data_lost += publishers.imu_data_lost(); });
  ros2::Diagnostic own;
  own.name = node_name() + ": relay";
  own.level = beacons == 0 ? ros2::Level::stale : ros2::Level::ok;
  own.message = beacons == 0 ? "no beacon received" : fmt::format("{} beacons", beacons);
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
    own.message +=
        fmt::format("; {} messages of imu/data lost, whose IMU samples did not arrive", imu_data_lost);
  }
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

/// Runs until the stop, or until `failed`.
void Relay::Impl::serve(const process::StopSignal& stop, const std::atomic<bool>& failed) {
  surroundings_.observe();
  node_.announce();
  SteadyTime next_status = clocks::steady_now() + status_period_ns;
  SteadyTime next_readers = source_ ? source_->update_readers() : SteadyTime::max();
  while (!failed && !stop.wait_until(std::min(next_status, next_readers), wakeup_)) {
    create_new_publishers();
    if (source_) next_readers = source_->update_readers();
    for_each_beacon([this](BeaconPublishers& publishers) {
      publishers.create_magnetic_writer(node_);
      if (mount_finder_) mount_finder_->assign_to(publishers);
    });
    surroundings_.observe();
    node_.announce();
    if (clocks::steady_now() < next_status) continue;
    next_status = clocks::steady_now() + status_period_ns;
    surroundings_.check_processes(has_writer(imu_), has_writer(pose_));
    publish_diagnostics();
    replace_tree_owner();
    for_each_beacon([](BeaconPublishers& publishers) {
      publishers.handle_overdue();
      publishers.publish_path();
    });
  }
}

/// Runs on a separate thread, because it waits for replies of the fusion.
void Relay::Impl::serve_parameters(const std::stop_token& end, const process::StopSignal& stop) {
  constexpr TimeNs retry_period_ns = 20'000'000;
  constexpr TimeNs hour_ns = 3'600'000'000'000;
  const std::stop_callback wake_to_end(end, [this] { parameters_wakeup_.wake(); });
  bool waits = false;
  do {
    try {
      waits = parameters_.serve();
    } catch (const std::exception& error) {  // also settings of a fusion of another version
      log_.error(fmt::format("parameters: {}", error.what()));
    }
  } while (!stop.wait_until(clocks::steady_now() + (waits ? retry_period_ns : hour_ns), parameters_wakeup_) &&
           !end.stop_requested());
}

void Relay::Impl::run(const process::StopSignal& stop) {
  log_.info("relaying as " + ros2::full_name(options_.names.node()));
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
  source_ = make_source(
      node_, options_.inputs, {timeout_ns(topics::imu), timeout_ns(topics::fix)}, options_.output.frames.map,
      [this](const std::string& line) { log_.warning(line); }, [this] { return clock_.now_ns(); });
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
