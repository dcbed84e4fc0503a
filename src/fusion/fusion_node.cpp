#include "fusion/fusion_node.hpp"

#include "clocks/clocks.hpp"
#include "fusion/beacon_estimators.hpp"
#include "fusion/gap_detector.hpp"
#include "fusion/input_monitor.hpp"
#include "fusion/pose_output.hpp"
#include "fusion/request_server.hpp"
#include "fusion/status_publisher.hpp"
#include "process/endpoint_counters.hpp"
#include "process/silence_detector.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/estimation/prediction.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::fusion {
namespace {

namespace topics = dds::topics;

/// The silence of the IMU after which its last sample is no longer used: its deadline, at most a second.
TimeNs input_deadline_ns(const dds::qos::Provider& qos) {
  constexpr TimeNs most_ns = 1'000'000'000;
  return std::min(most_ns, dds::deadline_of(qos.datareader_qos(topics::imu.profile)).count());
}

/// Live, a consumer that has stopped must not block the fusion.
dds::DomainOptions domain_options(const FusionOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.lossless;
  return domain;
}

constexpr std::uint64_t InputCounters::*counter_of(const sonopose_ImuSample& /*stream*/) {
  return &InputCounters::imu_deadlines_missed;
}
constexpr std::uint64_t InputCounters::*counter_of(const sonopose_UltrasonicFix& /*stream*/) {
  return &InputCounters::fix_deadlines_missed;
}
constexpr std::uint64_t InputCounters::*counter_of(const sonopose_PairHeading& /*stream*/) {
  return &InputCounters::heading_deadlines_missed;
}

}  // namespace

class FusionNode::Impl {
public:
  explicit Impl(const FusionOptions& options);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void publish_statuses();

  /// Asserts liveliness, releases stalled beacons and publishes the status of beacons whose IMU fell silent
  /// or resumed.
  void poll();
  [[nodiscard]] SteadyTime poll_by() const { return output_.poll_by(clocks::steady_now()); }

  /// Lets a standby process take over without a missed pose.
  void hand_over();

private:
  template <class T>
  void take(dds::DataReader<T>& reader) noexcept;
  void take(dds::DataReader<sonopose_ResetCommand>& reader) noexcept;
  void feed(const Event& event, dds::InstanceHandle bridge, TimeNs in_ns, SteadyTime steady) noexcept;
  void write(EventOutcome& outcome, TimeNs in_ns, SteadyTime steady) noexcept;
  void write(FusedPose& pose, SteadyTime steady) noexcept;
  void write(const SettingsChange& change) noexcept;
  std::optional<SettingsReply> answer(const SettingsRequest& request) noexcept;
  [[nodiscard]] std::uint64_t unwritten() const;
  void write_until_accepted(const auto& attempt) noexcept;
  void serve_lossless(const std::stop_token& stop);

  void publish_status(BeaconAddress address);
  void publish_estimate(BeaconAddress address);
  void log_fix_refusals(BeaconAddress address);
  void log_gaps();

  /// Passes on the samples and status changes of one topic, on the thread that receives them.
  template <class T>
  class Listener final : public process::CountingReaderListener<T> {
  public:
    explicit Listener(Impl& node) : process::CountingReaderListener<T>(node.endpoints_), node_(node) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override { node_.take(reader); }
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
  process::AddressSet addresses_;
  dds::DomainParticipant participant_;
  dds::qos::Provider qos_;
  dds::topics::Delivery delivery_;
  TimeNs input_deadline_ns_;

  // Guards the estimators and the state of their inputs. Not held while anything is read or written.
  std::mutex estimators_mutex_;
  BeaconEstimators estimators_;
  InputMonitor inputs_;
  process::SilenceDetector imu_silences_;
  std::map<BeaconAddress, std::uint64_t> last_reset_ids_;          // used by the receive thread
  std::vector<process::SilenceDetector::Change> silence_changes_;  // of poll(), kept for its capacity
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::atomic<bool> working_ = false;  // an event is being processed
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> waited_for_consumer_ = false;  // since the last log_gaps()
  GapDetector gaps_;

  process::EndpointCounters endpoints_;
  process::CountingWriterListener<sonopose_FixReport> report_listener_{endpoints_};
  PoseOutput output_;
  StatusPublisher status_publisher_;
  dds::DataWriter<sonopose_FixReport> report_writer_;
  dds::DataWriter<sonopose_EffectiveSettings> settings_writer_;

  Listener<sonopose_ImuSample> imu_listener_{*this};
  Listener<sonopose_UltrasonicFix> fix_listener_{*this};
  Listener<sonopose_PairHeading> heading_listener_{*this};
  Listener<sonopose_ResetCommand> reset_listener_{*this};
  // Readers last: their listeners may be called while the constructor still runs.
  dds::DataReader<sonopose_ImuSample> imu_reader_;
  dds::DataReader<sonopose_UltrasonicFix> fix_reader_;
  dds::DataReader<sonopose_PairHeading> heading_reader_;
  dds::DataReader<sonopose_ResetCommand> reset_reader_;
  std::unique_ptr<RequestServer> requests_;
  std::jthread lossless_thread_;
};

FusionNode::Impl::Impl(const FusionOptions& options)
    : lossless_(options.lossless),
      addresses_(options.addresses),
      participant_(domain_options(options)),
      qos_(options.qos_file),
      delivery_(options.lossless ? dds::topics::Delivery::lossless : dds::topics::Delivery::live),
      input_deadline_ns_(input_deadline_ns(qos_)),
      estimators_(options.config, options.lossless),
      imu_silences_(input_deadline_ns_),
      output_(participant_, qos_, delivery_, options.standby, input_deadline_ns_, endpoints_),
      status_publisher_(participant_, qos_, endpoints_),
      report_writer_(
          dds::topics::make_writer(participant_, qos_, topics::report, &report_listener_, delivery_)),
      settings_writer_(dds::topics::make_writer(participant_, qos_, topics::settings)) {
  write(estimators_.settings_for_all());
  const auto live = [this](auto& listener) { return lossless_ ? nullptr : &listener; };
  fix_reader_ = dds::topics::make_reader(participant_, qos_, topics::fix, live(fix_listener_), delivery_);
  heading_reader_ =
      dds::topics::make_reader(participant_, qos_, topics::heading, live(heading_listener_), delivery_);
  imu_reader_ = dds::topics::make_reader(participant_, qos_, topics::imu, live(imu_listener_), delivery_);
  reset_reader_ = dds::topics::make_reader(participant_, qos_, topics::reset, &reset_listener_);
  requests_ = std::make_unique<RequestServer>(
      participant_, qos_, [this](const SettingsRequest& request) { return answer(request); });
  if (lossless_) {
    lossless_thread_ = std::jthread([this](const std::stop_token& stop) { serve_lossless(stop); });
  }
}

FusionNode::Impl::~Impl() {
  stopping_ = true;
  lossless_thread_ = {};
  imu_reader_.close();
  fix_reader_.close();
  heading_reader_.close();
  reset_reader_.close();
  requests_.reset();
  // Unregister, so that consumers learn immediately that the poses end. (Lossless writers would block until
  // there is space; their consumers learn it from the end of the writers.)
  for (const BeaconAddress address : estimators_.addresses()) {
    if (!lossless_) output_.unregister(address);
    status_publisher_.unregister(address);
    sonopose_EffectiveSettings settings{};
    settings.address = address;
    settings_writer_.try_unregister_instance(settings);
  }
  sonopose_EffectiveSettings for_all{};
  for_all.address = all_beacons;
  settings_writer_.try_unregister_instance(for_all);
}

template <class T>
void FusionNode::Impl::take(dds::DataReader<T>& reader) noexcept {
  const TimeNs in_ns = clocks::host_now();
  const SteadyTime steady = clocks::steady_now();
  working_ = true;
  reader.try_take_each([&](const T& sample, const dds::SampleInfo& info) {
    if (stopping_ || !addresses_.contains(sample.address))
      return;  // a lossless reader may buffer minutes of samples
    feed(dds::topics::from_idl(sample), info.publication_handle(), in_ns, steady);
  });
  working_ = false;
}

void FusionNode::Impl::feed(const Event& event, dds::InstanceHandle bridge, TimeNs in_ns,
                            SteadyTime steady) noexcept {
  std::span<const collation::CollatedEvent> in_line;
  {
    const std::lock_guard lock(estimators_mutex_);
    if (std::holds_alternative<ImuSample>(event)) {
      inputs_.on_imu(address_of(event), bridge.value);
      imu_silences_.on_sample(address_of(event), steady);
    }
    in_line = estimators_.collate(event, steady);
  }
  for (const collation::CollatedEvent& next : in_line) {
    EventOutcome outcome;
    {
      const std::lock_guard lock(estimators_mutex_);
      outcome = estimators_.process(next);
    }
    write(outcome, in_ns, steady);
    if (!std::holds_alternative<ImuSample>(next.event)) {
      const std::lock_guard lock(estimators_mutex_);
      estimators_.catch_up(address_of(next.event));
    }
  }
}

void FusionNode::Impl::write(EventOutcome& outcome, TimeNs in_ns, SteadyTime steady) noexcept {
  if (outcome.settings) {
    output_.set_period(outcome.settings->address,
                       estimation::prediction_period_ns(outcome.settings->settings.output));
  }
  if (auto* pose = std::get_if<FusedPose>(&outcome.result)) {
    pose->fusion_in_time_ns = in_ns;
    write(*pose, steady);
  } else if (const auto* report = std::get_if<FixReport>(&outcome.result)) {
    const auto sample = dds::topics::to_idl(*report);
    write_until_accepted([&] { return report_writer_.try_write(sample); });
  }
  if (outcome.settings) write(*outcome.settings);
}

void FusionNode::Impl::write(FusedPose& pose, SteadyTime steady) noexcept {
  auto& writer = output_.writer_for(pose, steady);
  write_until_accepted([&] { return output_.write(writer, pose); });
}

void FusionNode::Impl::write(const SettingsChange& change) noexcept {
  const EffectiveSettings settings{.address = change.address,
                                   .time_ns = clocks::host_now(),
                                   .from_sequence = change.from_sequence,
                                   .values = config::texts_of(change.settings)};
  const auto sample = dds::topics::to_idl(settings);
  write_until_accepted([&] { return settings_writer_.try_write(sample.sample()); });
}

/// In lossless mode `attempt` is repeated until a slow consumer has space.
void FusionNode::Impl::write_until_accepted(const auto& attempt) noexcept {
  if (lossless_ && stopping_) return;  // each attempt may wait for a consumer
  dds::ReturnCode code = attempt();
  while (lossless_ && dds::is_timeout(code) && !stopping_) {
    waited_for_consumer_ = true;
    code = attempt();
  }
  if (code < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
}

void FusionNode::Impl::take(dds::DataReader<sonopose_ResetCommand>& reader) noexcept {
  reader.try_take_each([this](const sonopose_ResetCommand& command, const dds::SampleInfo&) {
    std::uint64_t& last_id = last_reset_ids_[command.address];
    if (command.request_id != 0 && command.request_id == last_id) return;
    last_id = command.request_id;
    const std::lock_guard lock(estimators_mutex_);
    estimators_.reset(command.address);
  });
}

/// On the thread of the requests.
std::optional<SettingsReply> FusionNode::Impl::answer(const SettingsRequest& request) noexcept {
  if (request.address != all_beacons && !addresses_.contains(request.address)) return std::nullopt;
  SettingsReply reply;
  std::optional<SettingsChange> for_all;
  {
    const std::lock_guard lock(estimators_mutex_);
    reply = estimators_.change_settings(request);
    if (reply.accepted && reply.address == all_beacons) for_all = estimators_.settings_for_all();
  }
  if (for_all) write(*for_all);  // before the reply, so that the client reads the new settings
  return reply;
}

std::uint64_t FusionNode::Impl::unwritten() const {
  return unwritten_ + output_.unwritten() + (requests_ ? requests_->unwritten() : 0);
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
    take(imu_reader_);
    take(fix_reader_);
    take(heading_reader_);
  }
}

template <class T>
void FusionNode::Impl::on_deadline_missed(dds::DataReader<T>& reader,
                                          const dds::RequestedDeadlineMissedStatus& status) noexcept {
  if constexpr (requires(const T& stream) { counter_of(stream); }) {
    T key{};
    if (status.total_count_change <= 0 || reader.try_key_value(key, {status.last_instance_handle}) < 0)
      return;
    const std::lock_guard lock(estimators_mutex_);
    inputs_.on_deadline_missed(key.address, counter_of(key),
                               static_cast<std::uint64_t>(status.total_count_change));
  }
}

void FusionNode::Impl::on_bridge_liveliness(const dds::LivelinessChangedStatus& status) noexcept {
  if (status.not_alive_count_change <= 0) return;
  const std::lock_guard lock(estimators_mutex_);
  inputs_.on_bridge_lost(status.last_publication_handle);
}

// Status

void FusionNode::Impl::poll() {
  const SteadyTime now = clocks::steady_now();
  output_.poll(now, working_);
  silence_changes_.clear();
  {
    const std::lock_guard lock(estimators_mutex_);
    imu_silences_.find_changes(now, silence_changes_);
  }
  for (const auto& change : silence_changes_) publish_status(change.address);
}

void FusionNode::Impl::hand_over() {
  output_.hand_over();
  if (!output_.is_standby()) return;
  constexpr TimeNs longest_ns = 1'000'000'000;  // for a profile with a long lease or without one
  const SteadyTime until = clocks::steady_now() + std::min(output_.lease_ns(), longest_ns);
  for (SteadyTime now = clocks::steady_now(); now < until; now = clocks::steady_now()) {
    poll();
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(poll_by(), until) - now));
  }
}

void FusionNode::Impl::publish_statuses() {
  std::vector<BeaconAddress> addresses;
  {
    const std::lock_guard lock(estimators_mutex_);
    addresses = estimators_.addresses();
  }
  for (const BeaconAddress address : addresses) {
    publish_status(address);
    publish_estimate(address);
    log_fix_refusals(address);
  }
  if (lossless_) log_gaps();
  status_publisher_.log_losses(unwritten());
}

void FusionNode::Impl::publish_status(BeaconAddress address) {
  std::optional<FusionStatus> status;
  InputCounters inputs;
  {
    const std::lock_guard lock(estimators_mutex_);
    status = estimators_.status(address);
    if (!status) return;
    status->imu_silent = imu_silences_.is_silent(address);
    inputs = inputs_.counters(address);
  }
  status->role = output_.role(address);
  status->poses_late = output_.poses_late(address);
  status->strength = output_.strength();
  if (!status_publisher_.publish(*status, inputs, unwritten())) ++unwritten_;
}

void FusionNode::Impl::publish_estimate(BeaconAddress address) {
  std::optional<Estimate> estimate;
  {
    const std::lock_guard lock(estimators_mutex_);
    estimate = estimators_.estimate(address);
  }
  if (estimate && !status_publisher_.publish(*estimate)) ++unwritten_;
}

void FusionNode::Impl::log_fix_refusals(BeaconAddress address) {
  std::optional<std::string> text;
  {
    const std::lock_guard lock(estimators_mutex_);
    text = estimators_.fix_refusals(address, clocks::steady_now());
  }
  if (text) fmt::print(stderr, "sonopose-fusion: beacon {}: {}\n", address, *text);
}

void FusionNode::Impl::log_gaps() {
  if (waited_for_consumer_.exchange(false)) gaps_.start_over();
  std::vector<std::string> texts;
  {
    const std::lock_guard lock(estimators_mutex_);
    for (const BeaconAddress address : estimators_.addresses()) {
      if (auto text = gaps_.on(address, estimators_.gap(address), clocks::steady_now()))
        texts.push_back(*std::move(text));
    }
  }
  for (const std::string& text : texts) fmt::print(stderr, "sonopose-fusion: {}\n", text);
}

FusionNode::FusionNode(const FusionOptions& options) : impl_(std::make_unique<Impl>(options)) {}
FusionNode::~FusionNode() = default;

void FusionNode::run(const process::StopSignal& stop) {
  constexpr TimeNs period_ns = 1'000'000'000;
  SteadyTime status_due = clocks::steady_now();
  do {
    impl_->poll();
    if (clocks::steady_now() < status_due) continue;
    impl_->publish_statuses();
    status_due += period_ns;
  } while (!stop.wait_until(std::min(status_due, impl_->poll_by())));
  impl_->hand_over();
}

}  // namespace sonopose::fusion
