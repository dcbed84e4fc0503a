#include "fusion/fusion_node.hpp"

#include "clocks/clocks.hpp"
#include "fusion/backlog_thread.hpp"
#include "fusion/beacon_estimators.hpp"
#include "fusion/outcome_writer.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_output.hpp"
#include "fusion/settings_server.hpp"
#include "fusion/status_publisher.hpp"
#include "logging/log.hpp"
#include "process/endpoint_counters.hpp"
#include "process/free_memory.hpp"
#include "process/guarded.hpp"
#include "process_log/log_publisher.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/collation/pause_compensated_clock.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/estimation/prediction.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <malloc.h>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::fusion {
namespace {

namespace topics = dds::topics;

/// Text to compare with a replay of a recording.
std::string end_of(BeaconAddress address, BeaconEstimator& estimator) {
  return fmt::format("beacon {}: state hash {} after event {}; {} lost", address, estimator.state_hash(),
                     estimator.last_sequence().value_or(0),
                     text::count_text(estimator.status().events_lost, "event"));
}

/// Silence of the IMU after which its last sample is no longer used: its deadline, at most a second.
TimeNs input_deadline_ns(const dds::qos::Provider& qos) {
  constexpr TimeNs max_ns = 1'000'000'000;
  return std::min(max_ns, dds::deadline_of(qos.datareader_qos(topics::imu.profile)).count());
}

/// Options of the domain. Live, a stalled consumer must not block the fusion.
dds::DomainOptions domain_options(const FusionOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.lossless;
  return domain;
}

constexpr std::uint64_t FusionStatus::*counter_of(const sonopose_ImuSample& /*stream*/) {
  return &FusionStatus::imu_deadlines_missed;
}
constexpr std::uint64_t FusionStatus::*counter_of(const sonopose_UltrasonicFix& /*stream*/) {
  return &FusionStatus::fix_deadlines_missed;
}
constexpr std::uint64_t FusionStatus::*counter_of(const sonopose_PairHeading& /*stream*/) {
  return &FusionStatus::heading_deadlines_missed;
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

  /// Lets a standby process take over without a missed pose.
  void hand_over();
  void finish_log();

private:
  template <class T>
  void on_data(dds::DataReader<T>& reader) noexcept;
  void on_data(dds::DataReader<sonopose_ResetCommand>& reader) noexcept;
  template <class T>
  void take(dds::DataReader<T>& reader, SteadyTime now) noexcept;
  void take_all() noexcept;
  void postpone_poll(SteadyTime now) noexcept;
  void feed(const Event& event, dds::InstanceHandle bridge, TimeNs in_ns, SteadyTime steady) noexcept;
  void end_output(BeaconAddress address);
  void remove_gone();
  void log_transitions(SteadyTime now);
  [[nodiscard]] std::uint64_t unwritten() const;
  void serve_lossless(const std::stop_token& stop);

  /// Passes on the samples and status changes of one topic, on the receiving thread.
  template <class T>
  class Listener final : public process::CountingReaderListener<T> {
  public:
    explicit Listener(Impl& node) : process::CountingReaderListener<T>(node.endpoints_), node_(node) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override { node_.on_data(reader); }
    void on_requested_deadline_missed(dds::DataReader<T>& reader,
                                      const dds::RequestedDeadlineMissedStatus& status) noexcept override {
      node_.on_deadline_missed(reader, status);
    }
    void on_liveliness_changed(dds::DataReader<T>& /*reader*/,
                               const dds::LivelinessChangedStatus& status) noexcept override {
      if (std::is_same_v<T, sonopose_ImuSample>) node_.on_bridge_liveliness(status);
    }

  private:
    Impl& node_;
  };

  template <class T>
  void on_deadline_missed(dds::DataReader<T>& reader,
                          const dds::RequestedDeadlineMissedStatus& status) noexcept;
  void on_bridge_liveliness(const dds::LivelinessChangedStatus& status) noexcept;

  bool lossless_;
  presence::BeaconAdmission admission_;
  dds::DomainParticipant participant_;
  dds::qos::Provider qos_;
  process_log::LogPublisher log_publisher_{participant_, qos_};
  dds::topics::Delivery delivery_;
  TimeNs input_deadline_ns_;

  process::Guarded<BeaconEstimators> estimators_;  // the lock guards each estimator too
  // Held by the thread that takes samples: Cyclone's receive thread, the backlog thread, or that of a writer
  // in this process. Guards the next four members and `outcome_writer_`.
  std::mutex taking_;
  Overload overload_;
  collation::PauseCompensatedClock unpaused_clock_;
  process::Alarm poll_alarm_;          // while in the future: latest time of the next `poll`
  SteadyTime postponed_at_;            // time of the last postponement
  std::atomic<bool> working_ = false;  // an event is being processed
  std::atomic<bool> stopping_ = false;

  process::EndpointCounters endpoints_;
  transitions::TransitionLog transition_log_;              // main thread only, like the next
  std::vector<transitions::TransitionQueue> transitions_;  // kept for its capacity
  PoseOutput output_;
  StatusPublisher status_publisher_;
  SettingsServer settings_server_;
  OutcomeWriter outcome_writer_;

  Listener<sonopose_ImuSample> imu_listener_{*this};
  Listener<sonopose_UltrasonicFix> fix_listener_{*this};
  Listener<sonopose_PairHeading> heading_listener_{*this};
  Listener<sonopose_ResetCommand> reset_listener_{*this};
  // Readers last: their listeners may be called before the constructor ends.
  dds::DataReader<sonopose_ImuSample> imu_reader_;
  dds::DataReader<sonopose_UltrasonicFix> fix_reader_;
  dds::DataReader<sonopose_PairHeading> heading_reader_;
  dds::DataReader<sonopose_ResetCommand> reset_reader_;
  std::jthread lossless_thread_;
  BacklogThread backlog_thread_;
  process::FreeMemory free_memory_;
};

FusionNode::Impl::Impl(const FusionOptions& options)
    : lossless_(options.lossless),
      admission_(options.addresses, options.max_beacons),
      participant_(domain_options(options)),
      qos_(options.qos_file),
      delivery_(options.lossless ? dds::topics::Delivery::lossless : dds::topics::Delivery::live),
      input_deadline_ns_(input_deadline_ns(qos_)),
      estimators_(options.config, options.lossless),
      output_(participant_, qos_, delivery_, options.standby, input_deadline_ns_, endpoints_),
      status_publisher_(participant_, qos_, estimators_, output_, overload_, endpoints_, transition_log_),
      settings_server_(participant_, qos_, estimators_, options.addresses),
      outcome_writer_(participant_, qos_, delivery_, output_, overload_, endpoints_, stopping_) {
  const auto input = [this](const auto& topic, auto& listener) {
    return topics::make_reader(participant_, qos_, topic, lossless_ ? nullptr : &listener, delivery_,
                               &admission_);
  };
  fix_reader_ = input(topics::fix, fix_listener_);
  heading_reader_ = input(topics::heading, heading_listener_);
  imu_reader_ = input(topics::imu, imu_listener_);
  reset_reader_ = dds::topics::make_reader(participant_, qos_, topics::reset, &reset_listener_);
  if (lossless_) {
    lossless_thread_ = std::jthread([this](const std::stop_token& stop) { serve_lossless(stop); });
  } else {
    backlog_thread_.start([this] { take_all(); },
                          [this] {
                            const std::lock_guard lock(taking_);
                            overload_.on_caught_up(clocks::steady_now());
                          });
  }
}

FusionNode::Impl::~Impl() {
  stopping_ = true;
  lossless_thread_ = {};
  backlog_thread_.stop();
  imu_reader_.close();
  fix_reader_.close();
  heading_reader_.close();
  reset_reader_.close();
  const auto addresses = estimators_.with([](auto& all) { return all.addresses(); });
  for (const BeaconAddress address : addresses) end_output(address);
  estimators_.with([](auto& all) {
    all.for_each([](BeaconAddress address, auto& estimator) { logging::info(end_of(address, estimator)); });
  });
}

/// Unregisters a beacon, so that consumers learn immediately that its poses and reports end. Lossless writers
/// would block until there is space; their consumers learn it when the writers end.
void FusionNode::Impl::end_output(BeaconAddress address) {
  if (!lossless_) {
    output_.unregister(address);
    outcome_writer_.unregister(address);
  }
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

template <class T>
void FusionNode::Impl::on_data(dds::DataReader<T>& reader) noexcept {
  if (overload_.is_deferring()) return backlog_thread_.wake();
  const std::lock_guard lock(taking_);
  const SteadyTime now = clocks::steady_now();
  unpaused_clock_.on_poll(now);
  take(reader, now);
  postpone_poll(now);
}

/// Postpones the poll while poses flow, so that the main thread does not wake for nothing.
void FusionNode::Impl::postpone_poll(SteadyTime now) noexcept {
  const auto asserted_until = output_.asserted_until(now);
  if (!asserted_until || now - postponed_at_ < output_.tick_ns()) return;
  postponed_at_ = now;
  const bool must_report =
      estimators_.with([&](const auto& all) { return all.have_unreported_changes(now, input_deadline_ns_); });
  poll_alarm_.set(must_report ? now : *asserted_until);
}

template <class T>
void FusionNode::Impl::take(dds::DataReader<T>& reader, SteadyTime now) noexcept {
  const TimeNs in_ns = clocks::host_now();
  working_ = true;
  reader.try_take_each([&](const T& sample, const dds::SampleInfo& info) {
    if (stopping_) return;  // a lossless reader may buffer minutes of samples
    feed(dds::topics::from_idl(sample), info.publication_handle(), in_ns, now);
  });
  outcome_writer_.write_newest();
  working_ = false;
}

/// Drains all readers, last stream first, so that an event's predecessors are already in a reader.
void FusionNode::Impl::take_all() noexcept {
  const std::lock_guard lock(taking_);
  const SteadyTime now = clocks::steady_now();
  unpaused_clock_.on_poll(now);
  overload_.on_round(now, clocks::thread_time_ns());
  take(heading_reader_, now);
  take(fix_reader_, clocks::steady_now());
  take(imu_reader_, clocks::steady_now());
}

void FusionNode::Impl::feed(const Event& event, dds::InstanceHandle bridge, TimeNs in_ns,
                            SteadyTime steady) noexcept {
  try {
    std::shared_ptr<BeaconEstimator> estimator;
    const auto in_line = estimators_.with([&](auto& all) {
      estimator = all.find_or_make(address_of(event));
      return estimator->collate(event, bridge.value, steady, unpaused_clock_.time());
    });
    for (const collation::CollatedEvent& next : in_line) {
      EventOutcome outcome = estimators_.with([&](auto&) { return estimator->process(next); });
      outcome_writer_.write(outcome, address_of(event), in_ns);
      if (outcome.settings_changed) settings_server_.on_change();
      estimators_.with([&](auto&) { estimator->finish_pending_work(); });
    }
  } catch (...) {
    // No memory for a new beacon. Terminating here keeps the reason, which g++ 12 loses if the exception
    // leaves an inlined noexcept function.
    std::terminate();
  }
}

void FusionNode::Impl::on_data(dds::DataReader<sonopose_ResetCommand>& reader) noexcept {
  reader.try_take_each([this](const sonopose_ResetCommand& command, const dds::SampleInfo&) {
    estimators_.with([&](auto& all) { all.reset(command.address, command.request_id); });
  });
}

std::uint64_t FusionNode::Impl::unwritten() const {
  return outcome_writer_.unwritten() + output_.unwritten() + settings_server_.unwritten();
}

void FusionNode::Impl::serve_lossless(const std::stop_token& stop) {
  const dds::ReadCondition imu(imu_reader_);
  const dds::ReadCondition fix(fix_reader_);
  const dds::ReadCondition heading(heading_reader_);
  dds::WaitSet waitset;
  waitset += imu;
  waitset += fix;
  waitset += heading;
  while (!stop.stop_requested()) {
    waitset.wait(std::chrono::milliseconds(100));
    const std::lock_guard lock(taking_);
    take(imu_reader_, clocks::steady_now());
    take(fix_reader_, clocks::steady_now());
    take(heading_reader_, clocks::steady_now());
  }
}

template <class T>
void FusionNode::Impl::on_deadline_missed(dds::DataReader<T>& reader,
                                          const dds::RequestedDeadlineMissedStatus& status) noexcept {
  if constexpr (requires(const T& stream) { counter_of(stream); }) {
    T key{};
    if (status.total_count_change <= 0 || reader.try_key_value(key, {status.last_instance_handle}) < 0)
      return;
    estimators_.with([&](auto& all) {
      BeaconEstimator* const estimator = all.find(key.address);
      if (estimator == nullptr) return;
      estimator->on_deadline_missed(counter_of(key), static_cast<std::uint64_t>(status.total_count_change));
    });
  }
}

void FusionNode::Impl::on_bridge_liveliness(const dds::LivelinessChangedStatus& status) noexcept {
  if (status.not_alive_count_change <= 0) return;
  const SteadyTime now = clocks::steady_now();
  estimators_.with([&](auto& all) {
    all.for_each([&](BeaconAddress, BeaconEstimator& estimator) {
      estimator.on_bridge_lost(status.last_publication_handle, now);
    });
  });
}

// Status

void FusionNode::Impl::poll() {
  const SteadyTime now = clocks::steady_now();
  output_.poll(now, working_);
  if (overload_.is_deferring() && working_) return;  // waiting samples may end a silence
  std::vector<BeaconAddress> changed;                // rarely any
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
  const bool postponed = poll_alarm_.at() > now;
  return stop.wait_until(postponed ? deadline : std::min(deadline, output_.poll_by(now)), poll_alarm_);
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
  status_publisher_.log_losses(unwritten(), true);
}

void FusionNode::Impl::hand_over() {
  output_.hand_over();
  if (!output_.is_standby()) return;
  constexpr TimeNs longest_ns = 1'000'000'000;  // for a profile with a long lease or none
  const SteadyTime until = clocks::steady_now() + std::min(output_.lease_ns(), longest_ns);
  for (SteadyTime now = clocks::steady_now(); now < until; now = clocks::steady_now()) {
    poll();
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(output_.poll_by(now), until) - now));
  }
}

void FusionNode::Impl::publish_statuses() {
  if (!lossless_) remove_gone();
  if (overload_.is_deferring()) backlog_thread_.wake();  // without samples nothing else ends the deferral
  if (const auto text = admission_.refusals()) logging::warning(*text);
  const SteadyTime now = clocks::steady_now();
  log_transitions(now);
  transition_log_.update(now);
  status_publisher_.publish_all(unwritten());
  if (lossless_) status_publisher_.log_gaps(outcome_writer_.take_waited());
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
  do {
    impl_->poll();
    if (clocks::steady_now() < status_due) continue;
    impl_->publish_statuses();
    status_due += period_ns;
  } while (!impl_->wait_for_poll(stop, status_due));
  impl_->hand_over();
  impl_->finish_log();
}

}  // namespace sonopose::fusion
