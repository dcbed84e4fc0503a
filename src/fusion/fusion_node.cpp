#include "fusion/fusion_node_impl.hpp"
#include "process/random_id.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/estimation/prediction.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace sonopose::fusion {
namespace {

namespace topics = dds::topics;

/// After how long a silence of the IMU nothing is made of its last sample any more: its deadline, or, where
/// the profile sets none, a second.
TimeNs input_deadline_ns(const dds::QosProvider& qos) {
  constexpr TimeNs most_ns = 1'000'000'000;
  return std::min(most_ns, dds::deadline_of(qos.datareader_qos(topics::imu.profile)).count());
}

/// Live, a consumer that has stopped holds nobody up.
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

FusionNode::Impl::Impl(const FusionOptions& options)
    : lossless_(options.lossless),
      addresses_(options.addresses),
      id_(process::random_id()),
      participant_(domain_options(options)),
      qos_(options.qos_file),
      delivery_(options.lossless ? dds::Delivery::lossless : dds::Delivery::live),
      input_deadline_ns_(input_deadline_ns(qos_)),
      estimators_(options.config, options.lossless),
      imu_silences_(input_deadline_ns_),
      output_(participant_, qos_, delivery_, options.standby, input_deadline_ns_, ends_),
      report_writer_(dds::make_writer(participant_, qos_, topics::report, &report_listener_, delivery_)),
      status_writer_(dds::make_writer(participant_, qos_, topics::fusion_status, &status_listener_)),
      reply_writer_(dds::make_writer(participant_, qos_, topics::settings_reply)),
      settings_writer_(dds::make_writer(participant_, qos_, topics::settings)) {
  write(estimators_.settings_for_all());
  const auto live = [this](auto& listener) { return lossless_ ? nullptr : &listener; };
  fix_reader_ = dds::make_reader(participant_, qos_, topics::fix, live(fix_listener_), delivery_);
  heading_reader_ = dds::make_reader(participant_, qos_, topics::heading, live(heading_listener_), delivery_);
  imu_reader_ = dds::make_reader(participant_, qos_, topics::imu, live(imu_listener_), delivery_);
  reset_reader_ = dds::make_reader(participant_, qos_, topics::reset, &reset_listener_);
  request_reader_ = dds::make_reader(participant_, qos_, topics::settings_request, &request_listener_);
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
  request_reader_.close();
  // Consumers hear at once that the poses end. (Lossless writers would wait for room first: there the
  // writers' own end must tell.)
  for (const BeaconAddress address : estimators_.addresses()) {
    if (!lossless_) output_.unregister(address);
    sonopose_FusionStatus status{};
    status.address = address;
    status.fusion_id = id_;
    status_writer_.try_unregister_instance(status);
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
  const TimeNs in_ns = process::host_now();
  const SteadyTime steady = process::steady_now();
  working_ = true;
  reader.try_take_each([&](const T& sample, const dds::SampleInfo& info) {
    if (stopping_ || !addresses_.contains(sample.address)) return;  // a lossless reader may hold minutes
    feed(dds::from_idl(sample), info.publication_handle(), in_ns, steady);
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
  }
}

void FusionNode::Impl::write(EventOutcome& outcome, TimeNs in_ns, SteadyTime steady) noexcept {
  if (outcome.settings) {
    output_.set_period(outcome.settings->address,
                       estimation::prediction_period_ns(outcome.settings->settings));
  }
  if (auto* pose = std::get_if<FusedPose>(&outcome.result)) {
    pose->fusion_in_time_ns = in_ns;
    write(*pose, steady);
  } else if (const auto* report = std::get_if<FixReport>(&outcome.result)) {
    write_to(report_writer_, dds::to_idl(*report));
  }
  if (outcome.settings) write(*outcome.settings);
}

void FusionNode::Impl::write(FusedPose& pose, SteadyTime steady) noexcept {
  auto& writer = output_.writer_for(pose, steady);
  pose.fusion_out_time_ns = process::host_now();
  write_to(writer, dds::to_idl(pose));
}

void FusionNode::Impl::write(const SettingsChange& change) noexcept {
  const EffectiveSettings settings{.address = change.address,
                                   .time_ns = process::host_now(),
                                   .from_sequence = change.from_sequence,
                                   .values = config::texts_of(change.settings)};
  write_to(settings_writer_, dds::to_idl(settings).sample());
}

template <class T>
void FusionNode::Impl::write_to(dds::DataWriter<T>& writer, const T& sample) noexcept {
  if (lossless_ && stopping_) return;  // each try may wait for a consumer, and there may be many to write
  dds::ReturnCode code = writer.try_write(sample);
  while (lossless_ && dds::is_timeout(code) && !stopping_) {
    waited_for_consumer_ = true;
    code = writer.try_write(sample);
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

void FusionNode::Impl::take(dds::DataReader<sonopose_SettingsRequest>& reader) noexcept {
  reader.try_take_each([this](const sonopose_SettingsRequest& sample, const dds::SampleInfo&) {
    if (sample.address != all_beacons && !addresses_.contains(sample.address)) return;
    const SettingsRequest request = dds::from_idl(sample);
    SettingsReply reply;
    std::optional<SettingsChange> for_all;
    {
      const std::lock_guard lock(estimators_mutex_);
      reply = estimators_.change_settings(request);
      if (reply.accepted && reply.address == all_beacons) for_all = estimators_.settings_for_all();
    }
    if (for_all) write(*for_all);  // before the reply, so that the client reads the new settings
    if (reply_writer_.try_write(dds::to_idl(reply)) < 0) ++unwritten_;
  });
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

FusionNode::FusionNode(const FusionOptions& options) : impl_(std::make_unique<Impl>(options)) {}
FusionNode::~FusionNode() = default;

void FusionNode::run(const process::StopSignal& stop) {
  constexpr TimeNs period_ns = 1'000'000'000;
  SteadyTime status_due = process::steady_now();
  do {
    impl_->watch();
    if (process::steady_now() < status_due) continue;
    impl_->publish_statuses();
    status_due += period_ns;
  } while (!stop.wait_until(std::min(status_due, impl_->watch_by())));
  impl_->hand_over();
}

}  // namespace sonopose::fusion
