#include "fusion/fusion_node.hpp"

#include "clocks/clocks.hpp"
#include "fusion/beacon_estimators.hpp"
#include "fusion/event_receiver.hpp"
#include "fusion/learned_sensors.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_publisher.hpp"
#include "fusion/settings_server.hpp"
#include "fusion/status_publisher.hpp"
#include "logging/log.hpp"
#include "process/endpoint_counters.hpp"
#include "process/free_memory.hpp"
#include "process/service.hpp"
#include "process_log/log_publisher.hpp"
#include "threads/guarded.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <malloc.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::fusion {
namespace {

/// Text to compare with a replay of a recording.
std::string end_of(BeaconAddress address, BeaconEstimator& estimator) {
  return fmt::format("beacon {}: state hash {} after event {}; {} lost", address, estimator.state_hash(),
                     estimator.last_sequence().value_or(0),
                     text::count_text(estimator.status().events_lost, "event"));
}

/// Silence of the IMU after which its last sample is no longer used: its deadline, at most a second.
TimeNs input_deadline_ns(const dds::qos::Provider& qos) {
  constexpr TimeNs max_ns = 1'000'000'000;
  return std::min(max_ns, dds::deadline_of(qos.datareader_qos(dds::topics::imu.profile)).count());
}

/// Options of the domain. Live, a stalled consumer must not block the fusion.
dds::DomainOptions domain_options(const FusionOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.lossless;
  return domain;
}

}  // namespace

class FusionNode::Impl {
public:
  explicit Impl(const FusionOptions& options);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void publish_statuses();

  /// Asserts liveliness, releases stalled beacons, and publishes the status of beacons whose IMU fell silent
  /// or resumed.
  void poll();

  /// Waits until `poll` is due, `deadline`, or the stop. Returns true once stopped.
  bool wait_for_poll(const process::StopSignal& stop, SteadyTime deadline);

  /// Replaces the settings by those of the configuration, or keeps them if it cannot be used.
  void reload();

  /// Lets a standby process take over without a missed pose.
  void hand_over();
  void finish_log();

private:
  void end_output(BeaconAddress address);
  void remove_gone();
  void log_transitions(SteadyTime now);
  [[nodiscard]] std::uint64_t unwritten() const;

  const bool lossless_;
  const std::function<config::FusionConfig()> read_again_;
  presence::BeaconAdmission admission_;
  dds::domain::DomainParticipant participant_;
  dds::qos::Provider qos_;
  process_log::LogPublisher log_publisher_{participant_, qos_};
  const dds::topics::Delivery delivery_;
  const TimeNs input_deadline_ns_;

  std::optional<LearnedSensorsFile> learned_file_;
  threads::Guarded<BeaconEstimators> estimators_;
  Overload overload_;
  process::EndpointCounters endpoints_;
  std::atomic<bool> stopping_ = false;

  // Main thread only.
  transitions::TransitionLog transition_log_;
  std::vector<transitions::TransitionQueue> transitions_;  // kept for its capacity
  process::FreeMemory free_memory_;

  PosePublisher pose_publisher_;
  StatusPublisher status_publisher_;
  SettingsServer settings_server_;
  std::optional<EventReceiver> receiver_;  // ends before the rest
};

FusionNode::Impl::Impl(const FusionOptions& options)
    : lossless_(options.lossless),
      read_again_(options.read_again),
      admission_(options.addresses, options.max_beacons,
                 options.lossless ? presence::BeaconAdmission::Pace::unlimited
                                  : presence::BeaconAdmission::Pace::limited),
      participant_(dds::ext::participant(domain_options(options))),
      qos_(options.qos_file),
      delivery_(options.lossless ? dds::topics::Delivery::lossless : dds::topics::Delivery::live),
      input_deadline_ns_(input_deadline_ns(qos_)),
      estimators_(options.config, options.lossless,
                  [this](BeaconAddress address, const settings::Settings& settings) {
                    return learned_file_ ? learned_file_->known(address, settings) : std::nullopt;
                  }),
      pose_publisher_(participant_, qos_, delivery_, options.standby, input_deadline_ns_, overload_,
                      endpoints_, stopping_),
      status_publisher_(participant_, qos_, estimators_, pose_publisher_, overload_, endpoints_,
                        transition_log_),
      settings_server_(participant_, qos_, estimators_, options.addresses) {
  if (options.learned_file) learned_file_.emplace(*options.learned_file, options.config);
  receiver_.emplace(participant_, qos_, delivery_, admission_,
                    EventReceiver::Targets{estimators_, pose_publisher_, settings_server_},
                    input_deadline_ns_, overload_, endpoints_, stopping_);
}

FusionNode::Impl::~Impl() {
  stopping_ = true;
  receiver_.reset();
  const auto addresses = estimators_.with([](auto& all) { return all.addresses(); });
  for (const BeaconAddress address : addresses) end_output(address);
  estimators_.with([](auto& all) {
    all.for_each([](BeaconAddress address, auto& estimator) { logging::info(end_of(address, estimator)); });
  });
}

/// Unregisters a beacon, so that consumers learn immediately that its output ends.
void FusionNode::Impl::end_output(BeaconAddress address) {
  pose_publisher_.unregister(address);
  status_publisher_.unregister(address);
  settings_server_.unregister(address);
}

void FusionNode::Impl::remove_gone() {
  const SteadyTime now = clocks::steady_now();
  // Destroy the estimators without the lock.
  const auto gone = estimators_.with([now](auto& all) { return all.remove_gone(now); });
  for (const auto& [address, estimator] : gone) {
    end_output(address);
    admission_.forget(address);
    transition_log_.forget(address);
    logging::info(end_of(address, *estimator));
    logging::info(fmt::format("beacon {}: gone; its estimate is discarded", address));
    free_memory_.on_freed();
  }
  free_memory_.give_back(now);
}

std::uint64_t FusionNode::Impl::unwritten() const {
  return pose_publisher_.unwritten() + settings_server_.unwritten();
}

// Status

void FusionNode::Impl::poll() {
  const SteadyTime now = clocks::steady_now();
  pose_publisher_.poll(now, receiver_->is_working());
  if (overload_.is_deferring() && receiver_->is_working()) return;  // waiting samples may end a silence
  std::vector<BeaconAddress> changed;                               // rarely any
  estimators_.with([&](auto& all) {
    all.for_each([&](BeaconAddress address, BeaconEstimator& estimator) {
      if (estimator.find_silence_change(now, input_deadline_ns_)) changed.push_back(address);
    });
  });
  for (const BeaconAddress address : changed) status_publisher_.publish_status(address, unwritten());
  log_transitions(now);
}

bool FusionNode::Impl::wait_for_poll(const process::StopSignal& stop, SteadyTime deadline) {
  const SteadyTime now = clocks::steady_now();
  const bool postponed = receiver_->poll_alarm().at() > now;
  // After `poll`, which waits for the locks of the engines: one that hangs ends the reports.
  deadline = std::min(deadline, process::report_progress_by(now));
  return stop.wait_until(postponed ? deadline : std::min(deadline, pose_publisher_.poll_by(now)),
                         receiver_->poll_alarm());
}

/// Logs recorded changes. Receiving threads only record them; the lines are formatted here, and the log's
/// thread writes them.
void FusionNode::Impl::log_transitions(SteadyTime now) {
  transitions_.clear();
  estimators_.with([this](auto& all) {
    all.for_each([this](BeaconAddress, BeaconEstimator& estimator) {
      transitions::TransitionQueue& pending = estimator.transitions();
      if (pending.empty()) return;
      transitions_.push_back(pending);
      pending.clear();
    });
  });
  for (transitions::TransitionQueue& pending : transitions_) transition_log_.take(pending, now);
}

void FusionNode::Impl::finish_log() {
  log_transitions(clocks::steady_now());
  transition_log_.finish();
  if (learned_file_) learned_file_->finish(estimators_);
  status_publisher_.log_losses(unwritten(), true);
}

void FusionNode::Impl::hand_over() {
  pose_publisher_.hand_over();
  if (!pose_publisher_.is_standby()) return;
  constexpr TimeNs max_ns = 1'000'000'000;  // for a profile with a long lease or none
  const SteadyTime until = clocks::steady_now() + std::min(pose_publisher_.lease_ns(), max_ns);
  for (SteadyTime now = clocks::steady_now(); now < until; now = clocks::steady_now()) {
    poll();
    std::this_thread::sleep_for(
        std::chrono::nanoseconds(std::min(pose_publisher_.poll_by(now), until) - now));
  }
}

void FusionNode::Impl::reload() {
  if (!read_again_) return;
  process::report_reloading();
  std::string status = "settings read again";
  try {
    settings_server_.replace(read_again_());
  } catch (const std::exception& error) {
    status = fmt::format("settings not reloaded, the previous ones stay: {}", error.what());
    logging::error(status);
  }
  process::report_reloaded(status);
}

void FusionNode::Impl::publish_statuses() {
  if (!lossless_) remove_gone();
  receiver_->update();
  if (const auto text = admission_.refusals()) logging::warning(*text);
  const SteadyTime now = clocks::steady_now();
  log_transitions(now);
  transition_log_.update(now);
  if (learned_file_) learned_file_->update(estimators_, now);
  logging::report_left_out();
  status_publisher_.publish_all(unwritten());
  if (lossless_) status_publisher_.log_gaps(pose_publisher_.take_waited());
}

FusionNode::FusionNode(const FusionOptions& options) {
  // A fixed threshold: otherwise glibc raises it and keeps the memory of ended estimators.
  constexpr int threshold_bytes = 128 * 1024;
  ::mallopt(M_MMAP_THRESHOLD, threshold_bytes);
  impl_ = std::make_unique<Impl>(options);
}
FusionNode::~FusionNode() = default;

void FusionNode::run(const process::StopSignal& stop) {
  constexpr TimeNs period_ns = 1'000'000'000;
  SteadyTime status_due = clocks::steady_now();
  process::report_ready();
  do {
    impl_->poll();
    if (process::ReloadRequest::take()) impl_->reload();
    if (clocks::steady_now() < status_due) continue;
    impl_->publish_statuses();
    status_due = std::max(status_due + period_ns, clocks::steady_now());  // missed ones are skipped
  } while (!impl_->wait_for_poll(stop, status_due));
  impl_->hand_over();
  impl_->finish_log();
}

}  // namespace sonopose::fusion
