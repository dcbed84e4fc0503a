#include "marvelmind/beacon_assembler.hpp"

#include "marvelmind/conversions.hpp"

#include <algorithm>

namespace sonopose::marvelmind {

namespace {

constexpr std::size_t max_pending = 256;
constexpr std::int32_t max_coordinate_mm = 10'000'000;  // 10 km, ten times beyond the range of any ultrasound
constexpr std::uint8_t max_quality_percent = 100;

/// Minimum distance of two measurements. Fixes are at least 50 ms apart; a closer one, in another kind of
/// packet, is the same measurement.
constexpr std::int64_t same_emission_ns = 20 * ns_per_ms;

int rank_of(const Stamp& stamp) {
  return stamp.base == TimeBase::unix_ms ? 1 : 0;
}
int rank_of(const RawImu& imu) {
  return rank_of(imu.time);
}
int rank_of(const Position& position) {
  return 2 * rank_of(position.time) + (position.in_cm ? 0 : 1);
}

bool is_in_range(const Position& position) {
  return std::all_of(position.xyz_mm.begin(), position.xyz_mm.end(),
                     [](std::int32_t mm) { return mm >= -max_coordinate_mm && mm <= max_coordinate_mm; });
}

}  // namespace

BeaconAssembler::BeaconAssembler(std::uint8_t address, TimeMapping mapping)
    : address_(address), clocks_(mapping) {
  pending_.reserve(max_pending);
}

// Arrival: clocks and generations observe every packet immediately; samples follow when the clocks have
// settled.

void BeaconAssembler::on(const RawImu& imu, TimeNs arrival_ns, EventSink sink) {
  if (!is_plausible(imu.time)) {
    reject(imu.time);
    return;
  }
  imu_generation_.on_packet(rank_of(imu), arrival_ns);
  observe(*content_time(imu), arrival_ns);
  take({imu, arrival_ns}, sink);
}

void BeaconAssembler::on(const Position& position, TimeNs arrival_ns, EventSink sink) {
  if (!is_plausible(position.time)) {
    reject(position.time);
    return;
  }
  position_generation_.on_packet(rank_of(position), arrival_ns);
  observe(*content_time(position), arrival_ns);
  take({position, arrival_ns}, sink);
}

void BeaconAssembler::on(const Quality& quality, TimeNs arrival_ns, EventSink sink) {
  take({quality, arrival_ns}, sink);
}

void BeaconAssembler::on(const Telemetry& telemetry) {
  battery_v_ = telemetry.battery_mv * 1e-3;
  rssi_dbm_ = telemetry.rssi_dbm;
}

void BeaconAssembler::take(const Arrived& arrived, EventSink sink) {
  if (pending_.size() == max_pending) finish(sink);
  pending_.push_back(arrived);
  flush(arrived.arrival_ns, sink);
}

void BeaconAssembler::observe(const ContentTime& sent, TimeNs arrival_ns) {
  if (clocks_.observe(sent, arrival_ns)) return;
  counters_.samples_rejected += pending_.size();  // stamped before the beacon's restart
  pending_.clear();
}

void BeaconAssembler::reject(const Stamp& stamp) {
  ++counters_.samples_rejected;
  if (stamp.ticks >= 0) ++counters_.stamps_too_late;
}

void BeaconAssembler::flush(TimeNs now_ns, EventSink sink) {
  clocks_.advance_to(now_ns);
  if (clocks_.settled()) drain(sink);
  expire(now_ns, sink);
}

void BeaconAssembler::finish(EventSink sink) {
  clocks_.settle();
  drain(sink);
  release(sink);
}

void BeaconAssembler::drain(EventSink sink) {
  for (const Arrived& arrived : pending_) {
    expire(arrived.arrival_ns, sink);
    std::visit([&](const auto& packet) { make(packet, arrived.arrival_ns, sink); }, arrived.packet);
  }
  pending_.clear();
}

// Samples

void BeaconAssembler::make(const RawImu& imu, TimeNs arrival_ns, EventSink sink) {
  if (imu_generation_.outranks(rank_of(imu), arrival_ns)) {
    ++counters_.duplicates;
    return;
  }
  if ((imu.flags & (imu_accel_not_available | imu_gyro_not_available)) != 0) {
    ++counters_.imu_unavailable;
    return;
  }
  newest_base_ = imu.time.base;
  ++counters_.imu_samples;
  sink(to_imu_sample(imu, clocks_.host_ns(imu.time)));
}

void BeaconAssembler::make(const Position& position, TimeNs arrival_ns, EventSink sink) {
  const TimeNs emission_ns = clocks_.host_ns(position.time);
  if (position_generation_.outranks(rank_of(position), arrival_ns) || is_duplicate(position, emission_ns)) {
    ++counters_.duplicates;
    return;
  }
  release(sink);  // the next quality packet belongs to this position
  last_position_ = position;
  last_emission_ns_ = emission_ns;
  if (!position.is_available()) {
    ++counters_.fixes_unavailable;
    return;
  }
  if (!is_in_range(position)) {
    ++counters_.samples_rejected;
    return;
  }
  if (position.angle.yaw_decideg() > PairAngle::max_yaw_decideg) ++counters_.samples_rejected;
  newest_base_ = position.time.base;
  waiting_ = Waiting{to_fix(position, emission_ns, arrival_ns), to_heading(position, emission_ns, arrival_ns),
                     arrival_ns + quality_wait_ns};
}

void BeaconAssembler::make(const Quality& quality, TimeNs /*arrival_ns*/, EventSink sink) {
  if (!waiting_) {
    ++counters_.quality_without_fix;
    return;
  }
  if (quality.quality_percent <= max_quality_percent) {
    waiting_->fix.quality_percent = quality.quality_percent;
  } else {
    ++counters_.samples_rejected;
  }
  release(sink);
}

void BeaconAssembler::release(EventSink sink) {
  if (!waiting_) return;
  const Waiting ready = *waiting_;
  waiting_.reset();
  ++counters_.fixes;
  sink(ready.fix);
  sink(ready.heading);
}

void BeaconAssembler::expire(TimeNs now_ns, EventSink sink) {
  if (waiting_ && now_ns >= waiting_->deadline_ns) release(sink);
}

bool BeaconAssembler::is_duplicate(const Position& position, TimeNs emission_ns) const {
  if (!last_position_) return false;
  if (rank_of(position) == rank_of(*last_position_)) return position.time == last_position_->time;
  const TimeNs later_ns = saturated_difference(emission_ns, last_emission_ns_);
  return later_ns > -same_emission_ns && later_ns < same_emission_ns;
}

// Generations

void BeaconAssembler::PacketKindTracker::on_packet(int other, TimeNs arrival_ns) {
  if (outranks(other, arrival_ns)) return;
  rank = other;
  received_ns = arrival_ns;
}

bool BeaconAssembler::PacketKindTracker::outranks(int other, TimeNs arrival_ns) const {
  return rank > other && arrival_ns - received_ns < generation_timeout_ns;
}

// Queries

std::optional<TimeNs> BeaconAssembler::sent_host_ns(const ContentTime& sent, TimeNs arrival_ns) {
  if (!is_plausible(sent.stamp)) return std::nullopt;
  observe(sent, arrival_ns);
  if (!clocks_.settled()) return std::nullopt;
  return clocks_.host_ns(sent.stamp) + sent.send_delay_ns.value_or(typical_time_passed_ns);
}

std::optional<TimeNs> BeaconAssembler::next_deadline_ns() const {
  auto earliest = clocks_.settles_at_ns();
  if (waiting_) earliest = std::min(earliest.value_or(waiting_->deadline_ns), waiting_->deadline_ns);
  return earliest;
}

BeaconStatus BeaconAssembler::status() const {
  BeaconStatus status;
  status.address = address_;
  status.battery_v = battery_v_;
  status.rssi_dbm = rssi_dbm_;
  status.fixes_unavailable = counters_.fixes_unavailable;
  status.samples_rejected = counters_.samples_rejected;
  status.clock_offset_s = clocks_.offset_s(newest_base_);
  status.clock_jitter_s = clocks_.jitter_s(newest_base_);
  status.clock_resets = clocks_.resets();
  return status;
}

}  // namespace sonopose::marvelmind
