#include "fusion/beacon_estimator.hpp"

#include "presence/beacon_admission.hpp"
#include <sonopose/estimation/prediction.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace sonopose::fusion {

using transitions::Kind;

BeaconEstimator::BeaconEstimator(BeaconAddress address, SettingsTimeline timeline, bool lossless)
    : timeline_(std::move(timeline)),
      estimator_(timeline_.settings()),
      sensor_faults_(timeline_.settings()),
      detector_(address) {
  counted_.address = address;
  transitions_.add({.address = address, .kind = Kind::found});
  if (lossless) collator_.emplace<collation::LosslessCollator>();
}

void BeaconEstimator::collate(const Event& event, std::uint64_t bridge, SteadyTime now, SteadyTime unpaused) {
  presence_.on_sample(now);
  if (std::holds_alternative<ImuSample>(event)) {
    bridge_ = bridge;
    imu_silence_.on_sample(now);
    const auto lost_at = std::exchange(bridge_lost_at_, std::nullopt);
    if (std::exchange(loss_is_counted_, false)) {
      transitions_.add({.address = counted_.address,
                        .kind = Kind::bridge_lost,
                        .begins = false,
                        .lasted_s = seconds_between(*lost_at, now)});
    }
  }
  auto* const live = std::get_if<collation::Collator>(&collator_);
  in_order_ = live != nullptr ? live->push(event, unpaused)
                              : std::get<collation::LosslessCollator>(collator_).push(event);
}

std::optional<EventOutcome> BeaconEstimator::process_next() noexcept {
  estimator_.finish_pending_work();
  if (in_order_.empty()) return std::nullopt;
  const collation::CollatedEvent& next = in_order_.front();
  in_order_ = in_order_.subspan(1);
  return process(next);
}

EventOutcome BeaconEstimator::process(const collation::CollatedEvent& collated) noexcept {
  const auto& [event, restart] = collated;
  // The restarted bridge plays an older recording.
  if (restart && available_at_ns(event) < estimator_.time_ns()) estimator_.reset();

  EventOutcome outcome;
  const bool first = !last_sequence_;
  std::uint64_t sequence = sequence_of(event);
  if (sequence == unnumbered) sequence = last_sequence_.value_or(0);  // used on arrival
  const bool changed = timeline_.advance(sequence);
  last_sequence_ = sequence;
  if (changed) {
    estimator_.configure(timeline_.settings());
    sensor_faults_.configure(timeline_.settings());
  }
  sensor_faults_.on(event);
  if (first || changed) {
    settings_changed_at_ = sequence;
    outcome.settings_changed = true;
    outcome.prediction_period_ns = estimation::prediction_period_ns(estimator_.settings().output);
  }
  refusals_.on(event, estimator_.settings().admission);
  if (const auto* fix = std::get_if<UltrasonicFix>(&event))
    height_check_.on(estimator_.settings().planar, *fix);
  outcome.result = estimation::process(estimator_, event);
  const auto* report = std::get_if<FixReport>(&outcome.result);
  if (report != nullptr) {
    if ((report->flags & fix_too_late) != 0) ++counted_.fixes_late;
    if (is_down_weighted(*report)) ++counted_.fixes_down_weighted;
    refusals_.on(*report);
    detector_.on(*report, transitions_);
  } else if (auto* pose = std::get_if<FusedPose>(&outcome.result)) {
    sensor_faults_.on(*pose);
    pose->status |= sensor_faults_.status(pose->time_ns);
    pose_status_ = pose->status;
    detector_.on(*pose, transitions_);
    poses_.add(*pose);
  }
  return outcome;
}

std::optional<std::string> BeaconEstimator::height_use() {
  const auto problem = height_check_.problem(height_contradicts_);
  const bool is_known = std::exchange(height_contradicts_, problem.has_value());
  if (!problem || is_known) return std::nullopt;
  return problem->text + ": " + problem->remedy;
}

void BeaconEstimator::on_bridge_lost(std::uint64_t bridge, SteadyTime now) noexcept {
  if (bridge == bridge_ && !bridge_lost_at_) bridge_lost_at_ = now;
}

void BeaconEstimator::on_bridge_ended(std::uint64_t bridge) noexcept {
  if (bridge == bridge_ && !loss_is_counted_) bridge_lost_at_.reset();
}

bool BeaconEstimator::find_silence_change(SteadyTime now, TimeNs deadline_ns) {
  const bool is_lost = is_loss_due(now);
  if (is_lost) {
    loss_is_counted_ = true;
    ++counted_.bridge_losses;
    transitions_.add({.address = counted_.address, .kind = Kind::bridge_lost});
  }
  const auto change = imu_silence_.find_change(now, deadline_ns);
  if (!change) return is_lost;
  transitions_.add({.address = counted_.address,
                    .kind = Kind::imu_silent,
                    .begins = change->silent,
                    .lasted_s = change->lasted_s});
  return true;
}

void BeaconEstimator::reset(std::uint64_t request_id) {
  if (request_id != 0 && request_id == last_reset_id_) return;
  last_reset_id_ = request_id;
  estimator_.reset();
}

std::optional<SettingsChange> BeaconEstimator::take_settings_change() {
  const auto from = std::exchange(settings_changed_at_, std::nullopt);
  if (!from) return std::nullopt;
  return SettingsChange{counted_.address, *from, estimator_.settings()};
}

bool BeaconEstimator::is_gone(SteadyTime now) const {
  return presence_.is_gone(now);
}

FusionStatus BeaconEstimator::status() {
  const EstimatorCounters& counted = estimator_.counters();
  const collation::CollatorCounters& order = order_counters();
  const auto raise = [](std::uint64_t& published, std::uint64_t count) {
    return published = std::max(published, count);
  };
  FusionStatus status = counted_;
  status.imu_samples = counted.imu_samples;
  status.fixes_used = counted.fixes_used;
  status.fixes_rejected = counted.fixes_rejected;
  // An engine may count these again, as unusable, if the next IMU sample refutes their stamps.
  status.headings = raise(counted_.headings, counted.headings);
  status.velocities_used = raise(counted_.velocities_used, counted.twists_used);
  status.velocities_rejected = raise(counted_.velocities_rejected, counted.twists_rejected);
  status.velocities_unused = counted.twists_unused;
  status.events_lost = order.lost;
  status.events_duplicated = order.duplicated;
  status.samples_invalid = counted.samples_invalid;
  status.imu_gaps = counted.imu_gaps;
  status.reset_counter = estimator_.reset_counter();
  status.imu_silent = imu_silence_.is_silent();
  return status;
}

Estimate BeaconEstimator::estimate() {
  estimator_.finish_pending_work();
  Estimate estimate = estimator_.estimate();
  estimate.address = counted_.address;
  return estimate;
}

std::optional<Estimate> BeaconEstimator::learned() {
  constexpr std::uint32_t doubtful = status_initialising | status_uncalibrated | status_stale |
                                     status_converging | status_imu_inconsistent | status_fixes_inconsistent |
                                     status_frozen_track | status_low_trust;
  if ((pose_status_ & doubtful) != 0) return std::nullopt;
  Estimate learned = estimate();
  if (!estimation::aiding::is_learned(learned)) return std::nullopt;
  return learned;
}

std::string BeaconEstimator::state_hash() {
  estimator_.finish_pending_work();
  estimation::Digest digest = poses_;
  digest.add(estimator_.snapshot());
  return digest.text();
}

std::optional<collation::LosslessCollator::Gap> BeaconEstimator::gap() const {
  const auto* collator = std::get_if<collation::LosslessCollator>(&collator_);
  return collator == nullptr ? std::nullopt : collator->gap();
}

const collation::CollatorCounters& BeaconEstimator::order_counters() const {
  return std::visit(
      [](const auto& of_kind) -> const auto& { return of_kind.counters(); }, collator_);
}

}  // namespace sonopose::fusion
