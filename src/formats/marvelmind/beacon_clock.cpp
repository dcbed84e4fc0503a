#include "marvelmind/beacon_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sonopose::marvelmind {

// Unwrapper

std::int64_t Unwrapper::unwrapped(const Stamp& stamp) const {
  if (stamp.base == TimeBase::unix_ms || !newest_ticks_) return stamp.ticks;
  // Prevents overflow by garbage that jumps ahead by weeks in each stamp: a century in the coarser unit.
  constexpr std::int64_t max_ticks = 200'000'000'000;
  const auto ahead = static_cast<std::uint32_t>(stamp.ticks) - static_cast<std::uint32_t>(*newest_ticks_);
  return std::min(*newest_ticks_ + static_cast<std::int32_t>(ahead), max_ticks);
}

std::int64_t Unwrapper::beacon_ns(const Stamp& stamp) const {
  return unwrapped(stamp) * (stamp.base == TimeBase::uptime_64ths ? ns_per_64th : ns_per_ms);
}

// SlewedLine

void SlewedLine::begin(std::int64_t beacon_ns, TimeNs host_ns) {
  *this = SlewedLine{};
  points_[0] = {beacon_ns, host_ns};
  size_ = 1;
}

void SlewedLine::advance(std::int64_t beacon_ns, TimeNs target_ns, double rate) {
  const Point& newest = point(size_ - 1);
  const auto interval_ns = static_cast<double>(beacon_ns - newest.beacon_ns);
  const TimeNs unslewed_ns =
      newest.host_ns + (beacon_ns - newest.beacon_ns) + std::llround(rate * interval_ns);
  const auto error_ns = static_cast<double>(target_ns - unslewed_ns);
  const double share = std::min(1.0, interval_ns / time_constant_ns);
  const double slew_ns = std::clamp(error_ns * share, -max_slew * interval_ns, max_slew * interval_ns);
  const Point next{beacon_ns, unslewed_ns + std::llround(slew_ns)};

  if (size_ == capacity) {
    first_ = (first_ + 1) % capacity;
    --size_;
  }
  points_[(first_ + size_) % capacity] = next;
  ++size_;
  rate_ = rate;
}

TimeNs SlewedLine::host_ns(std::int64_t beacon_ns) const {
  std::size_t i = size_ - 1;
  while (i > 0 && point(i).beacon_ns > beacon_ns) --i;
  const Point& from = point(i);
  const std::int64_t send_delay_ns = beacon_ns - from.beacon_ns;
  if (i + 1 == size_ || send_delay_ns < 0) {  // before the first or after the last point
    return from.host_ns + send_delay_ns + std::llround(rate_ * static_cast<double>(send_delay_ns));
  }
  const Point& to = point(i + 1);
  const double share =
      static_cast<double>(send_delay_ns) / static_cast<double>(to.beacon_ns - from.beacon_ns);
  return from.host_ns + std::llround(share * static_cast<double>(to.host_ns - from.host_ns));
}

// BeaconClock

void BeaconClock::observe(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns) {
  if (!begun_) {
    begin(stamp, send_delay_ns, arrival_ns);
    return;
  }
  const std::int64_t sent_ns = unwrapper_.beacon_ns(stamp) + send_delay_ns;
  if (sent_ns < newest_ns_ - overtaken_ns) {
    restart(stamp, send_delay_ns, arrival_ns);
    return;
  }
  if (sent_ns <= newest_ns_) return;  // overtaken, or a repeated stamp: no information
  if (!settled_ && envelope_.delay_ns(sent_ns) - (arrival_ns - sent_ns) > max_stored_ns) {
    restart(stamp, send_delay_ns, arrival_ns);
    return;
  }
  envelope_.add(sent_ns, arrival_ns);
  if (!settled_ && settling_delay_ns_ - envelope_.delay_ns(sent_ns) > draining_ns) {
    settling_delay_ns_ = envelope_.delay_ns(sent_ns);
    settles_from_ns_ = arrival_ns;
  }
  const TimeNs target_ns = sent_ns + envelope_.delay_ns(sent_ns);
  const TimeNs behind_ns = settled_ ? target_ns - line_.host_ns(sent_ns) : 0;
  if (behind_ns > max_behind_ns || behind_ns < -max_ahead_ns) {
    restart(stamp, send_delay_ns, arrival_ns);
    return;
  }
  newest_ns_ = sent_ns;
  unwrapper_.set_newest(stamp);
  if (settled_) line_.advance(sent_ns, target_ns, envelope_.rate());
  measure_jitter(sent_ns, arrival_ns);
  advance_to(arrival_ns);
}

void BeaconClock::begin(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns) {
  unwrapper_.restart();
  unwrapper_.set_newest(stamp);
  newest_ns_ = unwrapper_.beacon_ns(stamp) + send_delay_ns;
  envelope_.clear();
  envelope_.add(newest_ns_, arrival_ns);
  settling_delay_ns_ = envelope_.delay_ns(newest_ns_);
  settles_from_ns_ = arrival_ns;
  begun_ = true;
  settled_ = false;
}

void BeaconClock::restart(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns) {
  ++resets_;
  if (settled_) delay_before_ns_ = line_.newest_offset_ns();
  begin(stamp, send_delay_ns, arrival_ns);
}

void BeaconClock::advance_to(TimeNs now_ns) {
  const auto due_ns = settles_at_ns();
  if (due_ns && (now_ns >= *due_ns || now_ns < settles_from_ns_)) settle();
}

void BeaconClock::settle() {
  const std::int64_t delay_ns = envelope_.delay_ns(newest_ns_);
  line_.begin(newest_ns_, newest_ns_ + delay_ns);
  settled_ = true;
  const std::int64_t step_ns = delay_before_ns_.value_or(delay_ns) - delay_ns;
  delay_before_ns_.reset();
  if (std::abs(step_ns) < overtaken_ns) return;  // only the line became slow or fast
  ++steps_;
  newest_step_ns_ = step_ns;
}

std::optional<TimeNs> BeaconClock::settles_at_ns() const {
  if (!begun_ || settled_) return std::nullopt;
  return settles_from_ns_ + settling_ns;
}

double BeaconClock::offset_s() const {
  const std::int64_t offset_ns = settled_ ? line_.newest_offset_ns() : envelope_.delay_ns(newest_ns_);
  return static_cast<double>(offset_ns) * 1e-9;
}

void BeaconClock::measure_jitter(std::int64_t beacon_ns, TimeNs arrival_ns) {
  constexpr double share_of_the_new = 0.01;
  constexpr double max_lateness_s = 0.25;  // one pause of the host must not dominate
  const double lateness_s =
      static_cast<double>(arrival_ns - beacon_ns - envelope_.delay_ns(beacon_ns)) * 1e-9;
  jitter_s_ += share_of_the_new * (std::clamp(lateness_s, 0.0, max_lateness_s) - jitter_s_);
}

// FixedClock

TimeNs FixedClock::host_ns(const Stamp& stamp) const {
  const std::int64_t beacon_ns = unwrapper_.beacon_ns(stamp);
  const bool is_of_before = step_ && step_->under_way_ns == beacon_ns;
  return (is_of_before ? step_->line_before : line_).host_ns(beacon_ns);
}

void FixedClock::observe(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs arrival_ns) {
  if (!begun_) {
    begin(stamp, send_delay_ns, arrival_ns);
    return;
  }
  if (step_) step_->under_way_ns.reset();  // the new time may reach that stamp
  if (take_under_way(stamp, send_delay_ns)) return;
  take_step(stamp, send_delay_ns);
  const std::int64_t sent_ns = unwrapper_.beacon_ns(stamp) + send_delay_ns;
  if (sent_ns < newest_ns_) return;
  newest_ns_ = sent_ns;
  unwrapper_.set_newest(stamp);
}

/// Begins a step at this packet, if it is one. Ends the wait after an earlier one: a position of the new time
/// follows those that were under way.
void FixedClock::take_step(const Stamp& stamp, std::int64_t send_delay_ns) {
  const std::int64_t sent_ns = unwrapper_.beacon_ns(stamp) + send_delay_ns;
  const std::int64_t step_ns = sent_ns - newest_ns_;
  const bool was_settled = settled_;
  settled_ = settled_ || send_delay_ns > 0 || sent_ns - step_->first_ns >= settling_ns;
  if (step_ns >= -overtaken_ns && step_ns <= overtaken_ns) return;
  step_ = Step{line_, newest_ns_, sent_ns, std::nullopt};
  if (step_ns < 0 || step_ns >= set_ahead_ns) {
    ++resets_;
    count_step(step_ns);
    begin(stamp, send_delay_ns, line_.host_ns(newest_ns_));
  } else if (was_settled && send_delay_ns == 0) {  // otherwise a slow stream would wait again and again
    settled_ = false;
  }
}

/// Takes a position that was measured before the latest step and sent after it, if this is one.
bool FixedClock::take_under_way(const Stamp& stamp, std::int64_t send_delay_ns) {
  constexpr std::int64_t max_under_way_ns = 2'000'000'000;
  if (!step_ || send_delay_ns <= 0 || newest_ns_ - step_->first_ns > max_under_way_ns) return false;
  const std::int64_t beacon_ns = unwrapper_.beacon_ns(stamp);
  const std::int64_t ahead_ns = beacon_ns + send_delay_ns - newest_ns_;
  const std::int64_t to_clock_before_ns = std::abs(ahead_ns + step_->size_ns());
  // A position that is sent late after a short pause is not one of before it.
  if (to_clock_before_ns >= overtaken_ns || 4 * to_clock_before_ns >= std::abs(ahead_ns)) return false;
  step_->under_way_ns = beacon_ns;
  if (settled_) return true;
  line_ = {step_->line_before.host_ns(step_->newest_before_ns), step_->first_ns};
  settled_ = true;
  count_step(step_->size_ns());
  return true;
}

void FixedClock::count_step(std::int64_t step_ns) {
  ++steps_;
  newest_step_ns_ = step_ns;
}

void FixedClock::begin(const Stamp& stamp, std::int64_t send_delay_ns, TimeNs host_ns) {
  unwrapper_.restart();
  unwrapper_.set_newest(stamp);
  line_ = {host_ns, unwrapper_.beacon_ns(stamp) + send_delay_ns};
  newest_ns_ = line_.first_ns;
  begun_ = true;
  settled_ = true;
}

}  // namespace sonopose::marvelmind
