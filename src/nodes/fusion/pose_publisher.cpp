#include "fusion/pose_publisher.hpp"

#include "clocks/clocks.hpp"
#include "process/realtime.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <algorithm>
#include <chrono>
#include <pthread.h>
#include <utility>
#include <variant>

namespace sonopose::fusion {
namespace {

using dds::policy::Liveliness;
using dds::policy::LivelinessKind;
using dds::policy::OwnershipStrength;
using threads::Lock;

std::optional<Standby> standby_of(const std::optional<StandbyOptions>& options, TimeNs stall_ns) {
  return options ? std::optional<Standby>(std::in_place, *options, stall_ns) : std::nullopt;
}

template <class T>
T key_of(BeaconAddress address) {
  T key{};
  key.address = address;
  return key;
}

}  // namespace

PosePublisher::PosePublisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                             dds::topics::Delivery delivery, const std::optional<StandbyOptions>& standby,
                             TimeNs input_deadline_ns, Overload& overload,
                             process::EndpointCounters& counters, const std::atomic<bool>& stopping)
    : is_live_(delivery != dds::topics::Delivery::lossless),
      is_standby_(standby.has_value()),
      overload_(overload),
      stopping_(stopping),
      standby_(standby_of(standby, input_deadline_ns)),
      predictor_(input_deadline_ns),
      pose_listener_(counters),
      report_listener_(counters),
      report_writer_(
          dds::topics::make_writer(participant, qos, dds::topics::report, &report_listener_, delivery)) {
  const auto make = [&](process::CountingWriterListener<sonopose_FusedPose>* listener,
                        const dds::Qos& changes) {
    return dds::topics::make_writer(participant, qos, dds::topics::pose, listener, delivery, changes);
  };
  if (standby) {
    writer_ = make(&pose_listener_, dds::Qos() << OwnershipStrength(standby->strength));
    // Without the listener: while the process serves a beacon, this writer misses all of its deadlines.
    warming_writer_ = make(nullptr, dds::Qos() << OwnershipStrength(0));
  } else {
    writer_ = make(&pose_listener_, {});
  }
  const auto effective = writer_.qos();
  strength_ = effective.policy<OwnershipStrength>().value();
  const auto liveliness = effective.policy<Liveliness>();
  is_manual_ = liveliness.kind() == LivelinessKind::MANUAL_BY_TOPIC;
  lease_ns_ = dds::ext::to_chrono(liveliness.lease_duration()).count();
  if (!is_live_) return;
  predicting_thread_ = std::jthread([this](const std::stop_token& stop) { serve_predictions(stop); });
  ::pthread_setname_np(predicting_thread_.native_handle(), process::predicting_thread_name);
}

PosePublisher::~PosePublisher() = default;

// Poses and reports

void PosePublisher::publish(EventOutcome& outcome, BeaconAddress address, TimeNs in_ns) noexcept {
  if (outcome.settings_changed) set_period(address, outcome.prediction_period_ns);
  if (auto* pose = std::get_if<FusedPose>(&outcome.result)) {
    pose->fusion_in_time_ns = in_ns;
    if (!overload_.is_overloaded()) return publish(*pose);
    if (held_back_ && held_back_->address != address) publish_held_back();
    if (held_back_) count_skipped(address);
    held_back_ = *pose;
  } else if (const auto* report = std::get_if<FixReport>(&outcome.result)) {
    const auto sample = dds::topics::to_idl(*report);
    write_until_accepted([&] { return dds::ext::try_write(report_writer_, sample); });
  }
}

void PosePublisher::publish_held_back() noexcept {
  if (!held_back_) return;
  FusedPose& pose = *held_back_;
  if (is_due(pose)) {
    pose.status |= status_overloaded;
    publish(pose);
  } else {
    count_skipped(pose.address);
  }
  held_back_.reset();
}

/// Publishes a pose. Lateness is judged at this moment: the process may have been stopped since it took the
/// sample.
void PosePublisher::publish(FusedPose& pose) noexcept {
  if (PoseWriter* const writer = admit(pose, clocks::steady_now())) write(*writer, pose);
}

/// Returns the writer of a pose; null if a standby skips it as the backlog of a pause. Marks a pose
/// whose sample is old, and releases the beacon if necessary.
PosePublisher::PoseWriter* PosePublisher::admit(FusedPose& pose, SteadyTime now) noexcept {
  Standby::Step step{FusionRole::sole, false};
  TimeNs late_ns = 0;
  bool first_due = false;
  {
    const Lock lock(mutex_);
    Delay& delay = delays_[pose.address];
    if (is_live_) {
      const auto age = delay.age.on_sample({.sequence = pose.sequence,
                                            .sensor_ns = pose.imu_sensor_time_ns,
                                            .bridge_ns = pose.imu_bridge_time_ns,
                                            .host_ns = clocks::host_now(),
                                            .now = now});
      if (age.is_old) pose.status |= status_late;
      late_ns = age.late_ns;
    }
    delay.latest_ns = pose.time_ns;
    first_due = predictor_.on_pose(pose, now);
    due_times_changed_ |= first_due;
    if (standby_) step = standby_->on_pose(pose.address, pose.status, late_ns, now);
    if (step.skip) {
      ++delay.poses_skipped;
    } else if ((pose.status & status_late) != 0U) {
      ++delay.poses_late;
    }
  }
  overload_.on_pose(late_ns, now);
  if (first_due) wake_.notify_one();
  if (step.release) release(pose.address);
  return step.skip ? nullptr : &writer_of(step.role);
}

/// True if the beacon's latest pose is old enough for another one during an overload.
bool PosePublisher::is_due(const FusedPose& pose) const noexcept {
  const Lock lock(mutex_);
  const auto found = delays_.find(pose.address);
  if (found == delays_.end()) return true;
  const TimeNs since_ns = saturated_difference(pose.time_ns, found->second.latest_ns);
  return since_ns < 0 || since_ns >= overload_.pose_spacing_ns();
}

void PosePublisher::count_skipped(BeaconAddress address) noexcept {
  const Lock lock(mutex_);
  ++delays_[address].poses_skipped;
}

/// Stamps and writes a pose.
void PosePublisher::write(PoseWriter& writer, FusedPose& pose) noexcept {
  write_until_accepted([&] {
    pose.fusion_out_time_ns = clocks::host_now();
    const dds::ReturnCode code = dds::ext::try_write(writer, dds::topics::to_idl(pose));
    if (code >= 0) written_ns_.store(clocks::steady_now().ns, std::memory_order_relaxed);
    return code;
  });
}

/// Writes; in lossless mode repeats `attempt` until a slow consumer has space.
void PosePublisher::write_until_accepted(const auto& attempt) noexcept {
  if (!is_live_ && stopping_) return;  // each attempt may wait for a consumer
  const auto give_up = [this] {
    if (is_live_ || stopping_) return true;
    waited_ = true;
    return false;
  };
  if (dds::ext::retry_unless(give_up, attempt) < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
}

// Ownership and liveliness

PosePublisher::PoseWriter& PosePublisher::writer_of(FusionRole role) noexcept {
  return role == FusionRole::sole || role == FusionRole::serving ? writer_ : warming_writer_;
}

void PosePublisher::release(BeaconAddress address) noexcept {
  dds::ext::try_unregister_instance(writer_, key_of<sonopose_FusedPose>(address));
}

void PosePublisher::poll(SteadyTime now, bool busy) noexcept {
  // A pose asserts its writer's liveliness, which saves a message and its acknowledgement.
  if (is_manual_ && !busy && !asserted_until(now)) {
    dds::ext::try_assert_liveliness(writer_);
    if (is_standby_) dds::ext::try_assert_liveliness(warming_writer_);
  }
  if (!is_standby_) return;
  stalled_.clear();
  {
    const Lock lock(mutex_);
    standby_->find_stalled(now, stalled_);
  }
  for (const BeaconAddress address : stalled_) release(address);
}

TimeNs PosePublisher::tick_ns() const noexcept {
  constexpr TimeNs max_ns = 20'000'000;
  return is_manual_ ? std::min(max_ns, lease_ns_ / 5) : max_ns;
}

std::optional<SteadyTime> PosePublisher::asserted_until(SteadyTime now) const noexcept {
  const TimeNs before_ns = now.ns - written_ns_.load(std::memory_order_relaxed);
  if (is_standby_ || before_ns >= tick_ns()) return std::nullopt;
  return now + (5 * tick_ns() / 2 - before_ns);  // half a lease is left when poses end
}

SteadyTime PosePublisher::poll_by(SteadyTime now) const noexcept {
  if (!is_standby_) return asserted_until(now).value_or(now + tick_ns());
  const Lock lock(mutex_);
  return std::min(now + tick_ns(), std::max(standby_->next_stall(), now + 1'000'000));
}

void PosePublisher::hand_over() noexcept {
  predicting_thread_ = {};
  const Lock lock(mutex_);
  if (standby_) standby_->step_down();
}

void PosePublisher::unregister(BeaconAddress address) noexcept {
  {
    const Lock lock(mutex_);
    if (standby_) standby_->forget(address);
    predictor_.forget(address);
    delays_.erase(address);
  }
  if (!is_live_) return;
  release(address);
  if (is_standby_) dds::ext::try_unregister_instance(warming_writer_, key_of<sonopose_FusedPose>(address));
  dds::ext::try_unregister_instance(report_writer_, key_of<sonopose_FixReport>(address));
}

FusionRole PosePublisher::role(BeaconAddress address) const {
  return standby_ ? standby_->role(address) : FusionRole::sole;
}

PosePublisher::BeaconOutput PosePublisher::output_of(BeaconAddress address) const noexcept {
  const Lock lock(mutex_);
  BeaconOutput output{.role = role(address)};
  const auto found = delays_.find(address);
  if (found == delays_.end()) return output;
  output.poses_late = found->second.poses_late;
  output.poses_skipped = found->second.poses_skipped;
  return output;
}

// Predicted poses

/// Predicts a beacon's poses every `period_ns`, starting with its next pose; 0: never.
void PosePublisher::set_period(BeaconAddress address, TimeNs period_ns) noexcept {
  {
    const Lock lock(mutex_);
    if (!predictor_.set_period(address, period_ns)) return;
    due_times_changed_ = true;
  }
  wake_.notify_one();
}

void PosePublisher::serve_predictions(const std::stop_token& stop) {
  std::vector<FusedPose> due;
  while (!stop.stop_requested()) {
    const std::optional<SteadyTime> next = write_predictions(due);
    const auto due_times_changed = [this] {
      mutex_.assert_held();
      return std::exchange(due_times_changed_, false);
    };
    Lock lock(mutex_);
    if (!next) {
      wake_.wait(lock, stop, due_times_changed);
    } else {
      wake_.wait_until(lock, stop, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next->ns)),
                       due_times_changed);
    }
  }
}

std::optional<SteadyTime> PosePublisher::write_predictions(std::vector<FusedPose>& due) {
  due.clear();
  std::optional<SteadyTime> next;
  {
    const Lock lock(mutex_);
    next = predictor_.predict(clocks::steady_now(), [&](const FusedPose& pose) { due.push_back(pose); });
  }
  for (FusedPose& pose : due) {
    const FusionRole as = output_of(pose.address).role;
    if (as != FusionRole::stalled) write(writer_of(as), pose);
  }
  return next;
}

}  // namespace sonopose::fusion
