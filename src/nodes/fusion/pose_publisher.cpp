#include "fusion/pose_output.hpp"

#include "clocks/clocks.hpp"
#include "process/realtime.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <algorithm>
#include <chrono>
#include <pthread.h>
#include <utility>

namespace sonopose::fusion {
namespace {

using dds::policy::Liveliness;
using dds::policy::LivelinessKind;
using dds::policy::OwnershipStrength;

std::optional<Standby> standby_of(const std::optional<StandbyOptions>& options, TimeNs stall_ns) {
  return options ? std::optional<Standby>(std::in_place, *options, stall_ns) : std::nullopt;
}

sonopose_FusedPose key_of(BeaconAddress address) {
  sonopose_FusedPose key{};
  key.address = address;
  return key;
}

}  // namespace

PoseOutput::PoseOutput(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                       dds::topics::Delivery delivery, const std::optional<StandbyOptions>& standby,
                       TimeNs input_deadline_ns, process::EndpointCounters& counters)
    : standby_(standby_of(standby, input_deadline_ns)), predictor_(input_deadline_ns), listener_(counters) {
  const auto make = [&](const dds::Qos& changes) {
    return dds::topics::make_writer(participant, qos, dds::topics::pose, &listener_, delivery, changes);
  };
  if (standby) {
    writer_ = make(dds::Qos() << OwnershipStrength{standby->strength});
    warming_writer_ = make(dds::Qos() << OwnershipStrength{0});
  } else {
    writer_ = make({});
  }
  const dds::Qos effective = writer_.qos();
  strength_ = effective.policy<OwnershipStrength>().value_or(OwnershipStrength{}).value;
  const auto liveliness = effective.policy<Liveliness>().value_or(Liveliness{});
  is_manual_ = liveliness.kind == LivelinessKind::manual_by_topic;
  lease_ns_ = liveliness.lease_duration.count();
  is_live_ = delivery != dds::topics::Delivery::lossless;
  if (!is_live_) return;
  predicting_thread_ = std::jthread([this](const std::stop_token& stop) { serve_predictions(stop); });
  ::pthread_setname_np(predicting_thread_.native_handle(), process::predicting_thread_name);
}

PoseOutput::~PoseOutput() = default;

void PoseOutput::set_period(BeaconAddress address, TimeNs period_ns) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (!predictor_.set_period(address, period_ns)) return;
    due_times_changed_ = true;
  }
  wake_.notify_one();
}

PoseOutput::Route PoseOutput::route(FusedPose& pose, SteadyTime now) noexcept {
  Standby::Step step{FusionRole::sole, false};
  TimeNs late_ns = 0;
  bool first_due = false;
  {
    const std::lock_guard lock(mutex_);
    Delay& delay = delays_[pose.address];
    delay.latest_ns = pose.time_ns;
    // Steady time, so that a step of this host's clock delays nothing.
    late_ns =
        is_live_ ? delay.lateness.on_sample(saturated_difference(now.ns, pose.imu_bridge_time_ns), now) : 0;
    const TimeNs transit_ns = saturated_difference(pose.imu_bridge_time_ns, pose.time_ns);
    const bool left_late = is_live_ && delay.bridge_backlog.on_sample(transit_ns, now);
    if (late_ns > to_ns(late_after_s) || left_late) {
      pose.status |= status_late;
      ++delay.poses_late;
    }
    first_due = predictor_.on_pose(pose, now);
    due_times_changed_ |= first_due;
    if (standby_) {
      step = standby_->on_pose(pose.address, pose.status, late_ns, now);
      if (step.skip) ++delay.poses_skipped;
    }
  }
  if (first_due) wake_.notify_one();
  if (step.release) release(pose.address);
  return {step.skip ? nullptr : &writer_of(step.role), late_ns};
}

bool PoseOutput::is_due(const FusedPose& pose, TimeNs spacing_ns) const noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = delays_.find(pose.address);
  if (found == delays_.end()) return true;
  const TimeNs since_ns = saturated_difference(pose.time_ns, found->second.latest_ns);
  return since_ns < 0 || since_ns >= spacing_ns;
}

void PoseOutput::count_skipped(BeaconAddress address) noexcept {
  const std::lock_guard lock(mutex_);
  ++delays_[address].poses_skipped;
}

dds::ReturnCode PoseOutput::write(dds::DataWriter<sonopose_FusedPose>& writer, FusedPose& pose) noexcept {
  pose.fusion_out_time_ns = clocks::host_now();
  const dds::ReturnCode code = writer.try_write(dds::topics::to_idl(pose));
  if (code >= 0) written_ns_.store(clocks::steady_now().ns, std::memory_order_relaxed);
  return code;
}

dds::DataWriter<sonopose_FusedPose>& PoseOutput::writer_of(FusionRole role) noexcept {
  return role == FusionRole::sole || role == FusionRole::serving ? writer_ : warming_writer_;
}

void PoseOutput::release(BeaconAddress address) noexcept {
  writer_.try_unregister_instance(key_of(address));
}

void PoseOutput::poll(SteadyTime now, bool busy) noexcept {
  // A pose asserts its writer's liveliness, which saves a message and its acknowledgement.
  if (is_manual_ && !busy && !asserted_until(now)) {
    writer_.try_assert_liveliness();
    if (standby_) warming_writer_.try_assert_liveliness();
  }
  if (!standby_) return;
  stalled_.clear();
  {
    const std::lock_guard lock(mutex_);
    standby_->find_stalled(now, stalled_);
  }
  for (const BeaconAddress address : stalled_) release(address);
}

TimeNs PoseOutput::tick_ns() const noexcept {
  constexpr TimeNs longest_ns = 20'000'000;
  return is_manual_ ? std::min(longest_ns, lease_ns_ / 5) : longest_ns;
}

std::optional<SteadyTime> PoseOutput::asserted_until(SteadyTime now) const noexcept {
  const TimeNs before_ns = now.ns - written_ns_.load(std::memory_order_relaxed);
  if (standby_ || before_ns >= tick_ns()) return std::nullopt;
  return now + (5 * tick_ns() / 2 - before_ns);  // half a lease is left when poses end
}

SteadyTime PoseOutput::poll_by(SteadyTime now) const noexcept {
  if (!standby_) return asserted_until(now).value_or(now + tick_ns());
  const std::lock_guard lock(mutex_);
  return std::min(now + tick_ns(), std::max(standby_->next_stall(), now + 1'000'000));
}

void PoseOutput::hand_over() noexcept {
  predicting_thread_ = {};
  const std::lock_guard lock(mutex_);
  if (standby_) standby_->step_down();
}

void PoseOutput::unregister(BeaconAddress address) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (standby_) standby_->forget(address);
    predictor_.forget(address);
    delays_.erase(address);
  }
  writer_.try_unregister_instance(key_of(address));
  if (standby_) warming_writer_.try_unregister_instance(key_of(address));
}

FusionRole PoseOutput::role(BeaconAddress address) const noexcept {
  const std::lock_guard lock(mutex_);
  return standby_ ? standby_->role(address) : FusionRole::sole;
}

std::uint64_t PoseOutput::poses_late(BeaconAddress address) const noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = delays_.find(address);
  return found == delays_.end() ? 0 : found->second.poses_late;
}

std::uint64_t PoseOutput::poses_skipped(BeaconAddress address) const noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = delays_.find(address);
  return found == delays_.end() ? 0 : found->second.poses_skipped;
}

void PoseOutput::serve_predictions(const std::stop_token& stop) {
  std::vector<FusedPose> due;
  while (!stop.stop_requested()) {
    const std::optional<SteadyTime> next = write_predictions(due);
    const auto due_times_changed = [this] { return std::exchange(due_times_changed_, false); };
    std::unique_lock lock(mutex_);
    if (!next) {
      wake_.wait(lock, stop, due_times_changed);
    } else {
      wake_.wait_until(lock, stop, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next->ns)),
                       due_times_changed);
    }
  }
}

std::optional<SteadyTime> PoseOutput::write_predictions(std::vector<FusedPose>& due) {
  due.clear();
  std::optional<SteadyTime> next;
  {
    const std::lock_guard lock(mutex_);
    next = predictor_.predict(clocks::steady_now(), [&](const FusedPose& pose) { due.push_back(pose); });
  }
  for (FusedPose& pose : due) {
    const FusionRole as = role(pose.address);
    if (as == FusionRole::stalled) continue;
    if (write(writer_of(as), pose) < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
  }
  return next;
}

}  // namespace sonopose::fusion
