#include "fusion/event_receiver.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>

namespace sonopose::fusion {
namespace {

namespace topics = dds::topics;
using threads::Lock;

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

EventReceiver::EventReceiver(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                             topics::Delivery delivery, presence::BeaconAdmission& admission,
                             const Targets& targets, TimeNs input_deadline_ns, Overload& overload,
                             process::EndpointCounters& endpoints, const std::atomic<bool>& stopping)
    : input_deadline_ns_(input_deadline_ns),
      targets_(targets),
      endpoints_(endpoints),
      stopping_(stopping),
      overload_(overload) {
  const bool lossless = delivery == topics::Delivery::lossless;
  const auto input = [&](const auto& topic, auto& listener) {
    return topics::make_reader(participant, qos, topic, lossless ? nullptr : &listener, delivery, &admission);
  };
  fix_reader_ = input(topics::fix, fix_listener_);
  heading_reader_ = input(topics::heading, heading_listener_);
  twist_reader_ = input(topics::twist, twist_listener_);
  imu_reader_ = input(topics::imu, imu_listener_);
  reset_reader_ = topics::make_reader(participant, qos, topics::reset, &reset_listener_);
  if (lossless) {
    lossless_thread_ = std::jthread([this](const std::stop_token& stop) { serve_lossless(stop); });
  } else {
    backlog_thread_.start([this] { take_backlog(); }, [this] { on_caught_up(); });
  }
}

EventReceiver::~EventReceiver() {
  lossless_thread_ = {};
  backlog_thread_.stop();
  imu_reader_.close();
  fix_reader_.close();
  heading_reader_.close();
  twist_reader_.close();
  reset_reader_.close();
}

template <class T>
void EventReceiver::on_data(dds::sub::DataReader<T>& reader) noexcept {
  if (overload_.is_deferring()) return backlog_thread_.wake();
  const Lock lock(taking_);
  const SteadyTime now = clocks::steady_now();
  unpaused_clock_.on_poll(now);
  take(reader, now);
  postpone_poll(now);
}

template <class T>
void EventReceiver::take(dds::sub::DataReader<T>& reader, SteadyTime now) noexcept {
  is_working_ = true;
  dds::ext::try_take_each(reader, [&](const T& sample, const dds::sub::SampleInfo& info) {
    taking_.assert_held();
    if (stopping_) return;  // a lossless reader may buffer minutes of samples
    process(topics::from_idl(sample), info.publication_handle(), clocks::host_now(), now);
  });
  targets_.publisher.publish_held_back();
  is_working_ = false;
}

/// Passes an event, and those that waited for it, to the estimator and its results to the publisher. The lock
/// of the estimators is held twice for a sample: for its pose, and for the work that the pose need not await.
void EventReceiver::process(const Event& event, dds::core::InstanceHandle bridge, TimeNs in_ns,
                            SteadyTime now) noexcept {
  try {
    const BeaconAddress address = address_of(event);
    std::shared_ptr<BeaconEstimator> estimator;
    auto outcome = targets_.estimators.with([&](auto& all) {
      taking_.assert_held();
      estimator = all.find_or_make(address);
      estimator->collate(event, bridge.c_value(), now, unpaused_clock_.time());
      return estimator->process_next();
    });
    while (outcome) {
      targets_.publisher.publish(*outcome, address, in_ns);
      if (outcome->settings_changed) targets_.settings.on_change();
      outcome = targets_.estimators.with([&](auto&) { return estimator->process_next(); });
    }
  } catch (...) {
    // No memory for a new beacon. Terminating here keeps the reason, which g++ 12 loses if the exception
    // leaves an inlined noexcept function.
    std::terminate();
  }
}

void EventReceiver::postpone_poll(SteadyTime now) noexcept {
  const auto asserted_until = targets_.publisher.asserted_until(now);
  if (!asserted_until || now - postponed_at_ < targets_.publisher.tick_ns()) return;
  postponed_at_ = now;
  const bool must_report = targets_.estimators.with(
      [&](const auto& all) { return all.have_unreported_changes(now, input_deadline_ns_); });
  poll_alarm_.set(must_report ? now : *asserted_until);
}

/// Drains all readers, last stream first, so that an event's predecessors are already in a reader.
void EventReceiver::take_backlog() noexcept {
  const Lock lock(taking_);
  const SteadyTime now = clocks::steady_now();
  unpaused_clock_.on_poll(now);
  overload_.on_round(now, clocks::thread_time_ns());
  take(twist_reader_, now);
  take(heading_reader_, clocks::steady_now());
  take(fix_reader_, clocks::steady_now());
  take(imu_reader_, clocks::steady_now());
}

void EventReceiver::on_caught_up() noexcept {
  const Lock lock(taking_);
  overload_.on_caught_up(clocks::steady_now());
}

void EventReceiver::update() noexcept {
  if (overload_.is_deferring()) backlog_thread_.wake();
}

void EventReceiver::serve_lossless(const std::stop_token& stop) {
  const dds::sub::cond::ReadCondition imu(imu_reader_, dds::sub::status::DataState::any());
  const dds::sub::cond::ReadCondition fix(fix_reader_, dds::sub::status::DataState::any());
  const dds::sub::cond::ReadCondition heading(heading_reader_, dds::sub::status::DataState::any());
  const dds::sub::cond::ReadCondition twist(twist_reader_, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += imu;
  waitset += fix;
  waitset += heading;
  waitset += twist;
  while (!stop.stop_requested()) {
    dds::ext::wait(waitset, std::chrono::milliseconds(100));
    const Lock lock(taking_);
    take(imu_reader_, clocks::steady_now());
    take(fix_reader_, clocks::steady_now());
    take(heading_reader_, clocks::steady_now());
    take(twist_reader_, clocks::steady_now());
  }
}

void EventReceiver::on_data(dds::sub::DataReader<sonopose_ResetCommand>& reader) noexcept {
  dds::ext::try_take_each(reader, [this](const sonopose_ResetCommand& command, const dds::sub::SampleInfo&) {
    targets_.estimators.with([&](auto& all) { all.reset(command.address, command.request_id); });
  });
}

template <class T>
void EventReceiver::on_deadline_missed(
    dds::sub::DataReader<T>& reader,
    const dds::core::status::RequestedDeadlineMissedStatus& status) noexcept {
  if constexpr (requires(const T& stream) { counter_of(stream); }) {
    T key{};
    if (status.total_count_change() <= 0 ||
        dds::ext::try_key_value(reader, key, status.last_instance_handle()) < 0)
      return;
    targets_.estimators.with([&](auto& all) {
      BeaconEstimator* const estimator = all.find(key.address);
      if (estimator == nullptr) return;
      estimator->on_deadline_missed(counter_of(key), static_cast<std::uint64_t>(status.total_count_change()));
    });
  }
}

void EventReceiver::on_bridge_liveliness(const dds::core::status::LivelinessChangedStatus& status) noexcept {
  if (status.not_alive_count_change() <= 0) return;
  const SteadyTime now = clocks::steady_now();
  targets_.estimators.with([&](auto& all) {
    all.for_each([&](BeaconAddress, BeaconEstimator& estimator) {
      estimator.on_bridge_lost(status.last_publication_handle().c_value(), now);
    });
  });
}

void EventReceiver::on_bridge_matched(const dds::core::status::SubscriptionMatchedStatus& status) noexcept {
  if (status.current_count_change() >= 0) return;
  targets_.estimators.with([&](auto& all) {
    all.for_each([&](BeaconAddress, BeaconEstimator& estimator) {
      estimator.on_bridge_ended(status.last_publication_handle().c_value());
    });
  });
}

}  // namespace sonopose::fusion
