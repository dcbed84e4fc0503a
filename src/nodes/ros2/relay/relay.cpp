#include "ros2/relay/relay.hpp"

#include "logging/log.hpp"
#include "observation/beacon_observers.hpp"
#include "presence/beacon_admission.hpp"
#include "process/service.hpp"
#include "process_log/log_publisher.hpp"
#include "publication/sensor_publisher.hpp"
#include "ros2/relay/autopilot_output.hpp"
#include "ros2/relay/diagnostics_publisher.hpp"
#include "ros2/relay/fixed_frames.hpp"
#include "ros2/relay/foreign_mounts.hpp"
#include "ros2/relay/log.hpp"
#include "ros2/relay/native_receiver.hpp"
#include "ros2/relay/open_topics.hpp"
#include "ros2/relay/parameter_server.hpp"
#include "ros2/relay/peer_monitor.hpp"
#include "ros2/relay/relayed_beacons.hpp"
#include "ros2/relay/ros_clock.hpp"
#include "ros2/relay/transform_tree.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <stdexcept>
#include <stop_token>
#include <thread>

namespace sonopose::ros2::relay {
namespace {

namespace topics = dds::topics;

constexpr TimeNs status_period_ns = 1'000'000'000;

/// Time after which a killed relay disappears from the graph.
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
  for (const AidingInput& input : options.aiding_inputs) {
    const std::string prefix = ros2::topic_prefix(options.output.beacon_namespace, input.address);
    for (const char* const output : {"imu/data_raw", "imu/data", "odom", "pose", "fix"}) {
      if (options.names.topic(input.topic) != options.names.topic(prefix + output)) continue;
      throw std::invalid_argument(text_of(input) + " is the relay's own output of this beacon");
    }
  }
}

}  // namespace

class Relay::Impl {
public:
  explicit Impl(const RelayOptions& options);

  void run(const process::StopSignal& stop);

private:
  void on_transforms(const ros2::TFMessage& message);

  template <class Action>
  void for_each_beacon(const Action& action);
  void open_topics(const process::StopSignal& stop);
  void remove_gone();
  void log_transitions();
  void replace_tree_owner();
  void publish_mounts();
  void take_over_mounts();
  void serve(const process::StopSignal& stop, const std::atomic<bool>& failed);
  InputFrames frames_of_inputs();
  void bridge_while(const std::function<void()>& serve, std::atomic<bool>& failed);
  void serve_parameters(const std::stop_token& end, const process::StopSignal& stop);

  RelayOptions options_;
  presence::BeaconAdmission admission_;
  dds::domain::DomainParticipant participant_;
  dds::qos::Provider qos_;
  process_log::LogPublisher log_publisher_{participant_, qos_};
  ros2::Node node_;
  Log log_;
  transitions::TransitionLog transition_log_;  ///< main thread only
  RosClock clock_;
  process::Wakeup wakeup_;  ///< wakes the main thread
  process::Wakeup parameters_wakeup_;
  ParameterServer parameters_;
  PeerMonitor peers_;
  dds::pub::DataWriter<ros2::TFMessage> tf_writer_ = dds::core::null;
  TransformTree tree_;
  std::unique_ptr<Source> source_;  ///< null without inputs
  observation::BeaconObservers observers_;
  process::EndpointCounters endpoints_;
  DiagnosticsPublisher diagnostics_;

  RelayedBeacons beacons_;
  OpenTopics open_topics_{{.beacons = beacons_,
                           .admission = admission_,
                           .node = node_,
                           .output = options_.output,
                           .tf = tf_writer_,
                           .tree = tree_,
                           .wakeup = wakeup_}};

  std::unique_ptr<AutopilotOutput> autopilot_;  ///< null: none

  // Readers are last, so that they are destroyed first and no callback uses a destroyed member.
  dds::ext::SampleListener<ros2::TFMessage> tf_listener_{
      [this](const ros2::TFMessage& message, const auto&) { on_transforms(message); }};
  dds::sub::DataReader<ros2::TFMessage> tf_reader_ = dds::core::null;
  std::unique_ptr<ForeignMounts> foreign_mounts_;  ///< null unless this node publishes the mount
  std::unique_ptr<FixedFrames> fixed_frames_;      ///< null unless an input or the mount needs it
  std::optional<NativeReceiver> receiver_;
};

Relay::Relay(const RelayOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Relay::~Relay() = default;

void Relay::run(const process::StopSignal& stop) {
  impl_->run(stop);
}

Relay::Impl::Impl(const RelayOptions& options)
    : options_(with_lease(options)),
      admission_(options.addresses, options.max_beacons),
      participant_(dds::ext::participant(options_.domain, ros2::participant_qos(options.enclave))),
      qos_(options.qos_file),
      node_(participant_, qos_, options.names, options.distro.value_or(ros2::layout_without_others),
            options.qos_overrides),
      clock_(node_, options.use_sim_time),
      parameters_(node_, participant_,
                  {.qos_file = options.qos_file,
                   .startup_settings = options.startup_settings,
                   .own_parameters = options.own_parameters,
                   .addresses = options.addresses,
                   .max_beacons = options.max_beacons},
                  [this] { parameters_wakeup_.wake(); }),
      peers_(options_, participant_, node_, parameters_, [this] { wakeup_.wake(); }),
      tree_(options_, node_, clock_),
      observers_(dds::deadline_of(qos_.datareader_qos(topics::pose.profile)).count()),
      diagnostics_(options_, node_, clock_, observers_, endpoints_),
      beacons_(wakeup_, options.max_beacons) {
  check_inputs(options);
  if (options.rosout) log_.publish_as(node_);
  if (options.output.tf != TfMode::off) tf_writer_ = node_.make_writer<ros2::TFMessage>("/tf", "ros2::Tf");
  if (options.output.tf == TfMode::map_odom) {
    tf_reader_ = node_.make_reader<ros2::TFMessage>("/tf", "ros2::Tf", &tf_listener_);
  }
  if (options.output.mount_from_tf) {
    fixed_frames_ = std::make_unique<FixedFrames>(node_, [this] { wakeup_.wake(); });
  }
  if (options.output.publishes_mount()) {
    foreign_mounts_ = std::make_unique<ForeignMounts>(node_, [this] { wakeup_.wake(); });
  }
  if (options.autopilot) autopilot_ = std::make_unique<AutopilotOutput>(node_, *options.autopilot);
  node_.announce();
  receiver_.emplace(participant_, qos_, options, admission_,
                    NativeReceiver::Targets{beacons_, observers_, endpoints_, autopilot_.get()});
}

/// Calls `action` without the lock.
template <class Action>
void Relay::Impl::for_each_beacon(const Action& action) {
  for (const auto& [address, publishers] : beacons_.all()) action(*publishers);
}

/// Takes transforms on the receive thread, from any program: nearly all belong to others.
void Relay::Impl::on_transforms(const ros2::TFMessage& message) {
  constexpr std::uint32_t max_transforms = 1024;
  const auto beacons = beacons_.all();
  for (std::uint32_t i = 0; i < std::min(message.transforms._length, max_transforms); ++i) {
    const ros2::TransformStamped& transform = message.transforms._buffer[i];
    for (const auto& [address, publishers] : beacons) {
      const ros2::FrameNames& frames = publishers->frames();
      if (frames.odom != ros2::without_slash(transform.header.frame_id) ||
          frames.base != ros2::without_slash(transform.child_frame_id)) {
        continue;
      }
      const auto time_ns = ros2::from_ros(transform.header.stamp);
      const auto base_in_odom = ros2::transform_of(transform);
      if (time_ns && base_in_odom) publishers->on_odometry(*time_ns, *base_in_odom);
    }
  }
}

void Relay::Impl::open_topics(const process::StopSignal& stop) {
  const OpenTopics::Opened opened = open_topics_.open_requested(stop);
  if (opened.empty()) return;
  for (const auto& [address, publishers] : opened) receiver_->assign_fix_std_to(*publishers, address);
  publish_mounts();
}

void Relay::Impl::remove_gone() {
  const SteadyTime now = clocks::steady_now();
  for (const auto& text : receiver_->refusals()) {
    if (text) logging::warning(*text);
  }
  for (const BeaconAddress address : open_topics_.remove_gone(now)) transition_log_.forget(address);
  for (const auto& view : observers_.remove_gone(now, clocks::host_now())) {
    diagnostics_.forget(view.address);
  }
}

void Relay::Impl::log_transitions() {
  const SteadyTime now = clocks::steady_now();
  for_each_beacon([&](BeaconPublishers& publishers) {
    transitions::TransitionQueue pending = publishers.take_transitions();
    transition_log_.take(pending, now);
  });
  for (const observation::PoseSilence& change : observers_.silence_changes()) {
    transition_log_.on({.address = change.address,
                        .kind = transitions::Kind::poses_silent,
                        .begins = change.silent,
                        .lasted_s = change.lasted_s},
                       now);
  }
  transition_log_.update(now);
  logging::report_left_out();
}

/// Hands the transforms of a gone or absent beacon to one with the same frames.
void Relay::Impl::replace_tree_owner() {
  const auto owner = tree_.owner();
  if (!owner || !diagnostics_.is_gone(*owner)) return;
  const auto known = beacons_.all();
  const auto next = std::find_if(known.begin(), known.end(),
                                 [&](const auto& entry) { return diagnostics_.is_present(entry.first); });
  if (next == known.end()) return;
  if (const auto before = beacons_.find(*owner)) before->set_in_tree(false);
  tree_.hand_over(next->first);
  next->second->set_in_tree(true);
  publish_mounts();
}

void Relay::Impl::publish_mounts() {
  std::vector<std::pair<ros2::FrameNames, ros2::Mount>> in_tree;
  for_each_beacon([&](const BeaconPublishers& publishers) {
    const auto mount = publishers.mount();
    if (publishers.is_in_tree() && mount) in_tree.emplace_back(publishers.frames(), *mount);
  });
  tree_.publish_mounts(in_tree);
}

/// Gives way to another node that publishes a mount.
void Relay::Impl::take_over_mounts() {
  if (!foreign_mounts_) return;
  foreign_mounts_->forget_gone();
  bool changed = false;
  for_each_beacon([&](BeaconPublishers& publishers) { changed |= foreign_mounts_->assign_to(publishers); });
  if (changed) publish_mounts();
}

/// Runs until the stop, or until `failed`.
void Relay::Impl::serve(const process::StopSignal& stop, const std::atomic<bool>& failed) {
  peers_.observe();
  node_.announce();
  SteadyTime next_status = clocks::steady_now() + status_period_ns;
  SteadyTime readers_due = next_status;
  process::report_ready();
  const auto wake_at = [&] {
    return std::min({next_status, readers_due, process::report_progress_by(clocks::steady_now())});
  };
  while (!failed && !stop.wait_until(wake_at(), wakeup_)) {
    open_topics(stop);
    if (source_) readers_due = source_->update_readers();
    for_each_beacon([this](BeaconPublishers& publishers) {
      publishers.create_magnetic_writer(node_);
      if (options_.output.mount_from_tf) fixed_frames_->assign_mount_to(publishers);
    });
    take_over_mounts();
    peers_.observe();
    node_.announce();
    if (clocks::steady_now() < next_status) continue;
    next_status = clocks::steady_now() + status_period_ns;
    if (!source_) readers_due = next_status;
    peers_.check_processes(receiver_->has_bridge(), receiver_->has_fusion());
    peers_.check_clock(clock_);
    log_transitions();
    if (source_) source_->log_changes();
    if (autopilot_) autopilot_->log_changes();
    remove_gone();
    diagnostics_.publish(beacons_.all(), source_.get());
    replace_tree_owner();
    for_each_beacon([](BeaconPublishers& publishers) {
      publishers.handle_overdue();
      publishers.publish_path();
    });
  }
}

/// Serves parameters on a separate thread, because it waits for replies of the fusion.
void Relay::Impl::serve_parameters(const std::stop_token& end, const process::StopSignal& stop) {
  constexpr TimeNs retry_period_ns = 20'000'000;
  constexpr TimeNs hour_ns = 3'600'000'000'000;
  const std::stop_callback wake_to_end(end, [this] { parameters_wakeup_.wake(); });
  bool waits = false;
  do {
    try {
      waits = parameters_.serve([&] { return stop.requested() || end.stop_requested(); });
    } catch (const std::exception& error) {  // includes settings of a fusion of another version
      logging::error(fmt::format("parameters: {}", error.what()));
      waits = true;  // requests may be pending
    }
  } while (!stop.wait_until(clocks::steady_now() + (waits ? retry_period_ns : hour_ns), parameters_wakeup_) &&
           !end.stop_requested());
}

void Relay::Impl::run(const process::StopSignal& stop) {
  logging::info("relaying as " + ros2::full_name(options_.names.node()));
  const std::jthread parameters([&](const std::stop_token& end) { serve_parameters(end, stop); });
  std::atomic<bool> failed = false;
  if (options_.inputs.empty() && options_.aiding_inputs.empty()) {
    serve(stop, failed);
  } else {
    bridge_while([&] { serve(stop, failed); }, failed);
  }
  log_transitions();
  if (source_) source_->log_changes();
  transition_log_.finish();
}

InputFrames Relay::Impl::frames_of_inputs() {
  const bool mount_from_tf = options_.output.mount_from_tf;
  const bool needs_tf =
      std::ranges::any_of(options_.inputs, [](const Input& input) { return !input.tag_frame.empty(); }) ||
      std::ranges::any_of(options_.aiding_inputs,
                          [](const AidingInput& input) { return input.kind != AidingInput::Kind::wheels; });
  if (needs_tf && !fixed_frames_) fixed_frames_ = std::make_unique<FixedFrames>(node_);
  const auto mount = [this, mount_from_tf](BeaconAddress address) -> std::optional<Mount> {
    if (mount_from_tf) {
      const ros2::FrameNames names = ros2::for_beacon(options_.output.frames, address);
      const auto found = fixed_frames_->find(names.base, names.imu);
      if (!found) return std::nullopt;
      return Mount{.imu_in_base_m = found->translation_m, .q_imu_to_base = found->rotation};
    }
    const auto publishers = beacons_.find(address);  // has another node's, once taken over
    return (publishers ? publishers->mount() : std::nullopt).value_or(options_.output.mount);
  };
  FindFrame find;
  if (fixed_frames_) {
    find = [tf = fixed_frames_.get()](const auto& in, const auto& frame) { return tf->find(in, frame); };
  }
  return input_frames(options_.output.frames, mount, find);
}

/// Runs a bridge for the inputs on a separate thread while `serve` runs. Rethrows an exception of the bridge.
void Relay::Impl::bridge_while(const std::function<void()>& serve, std::atomic<bool>& failed) {
  const auto timeout_ns = [this](const auto& entry) {
    return std::min(status_period_ns * 10, dds::deadline_of(qos_.datareader_qos(entry.profile)).count());
  };
  source_ = make_source(node_, options_.inputs, {timeout_ns(topics::imu), timeout_ns(topics::fix)},
                        options_.output.frames.map, logging::write, [this] { return clock_.now_ns(); });
  source_->use(frames_of_inputs());
  if (!options_.aiding_inputs.empty()) {
    auto aiding = std::make_unique<AidingInputs>(node_, options_.aiding_inputs, frames_of_inputs(),
                                                 timeout_ns(topics::twist));
    parameters_.add(aiding->services());
    source_->use(std::move(aiding));
  }
  publication::SensorPublisher bridge(
      participant_, {.qos_file = options_.qos_file, .record_folder = {}, .publishes_log = false});
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
