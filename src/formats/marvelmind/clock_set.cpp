#include "marvelmind/clock_set.hpp"

#include <algorithm>

namespace sonopose::marvelmind {

namespace {

/// Greatest plausible time of a position through the system; a larger one would set the clock ahead.
constexpr std::uint16_t max_time_passed_ms = 2000;

}  // namespace

std::optional<ContentTime> content_time(const Packet& packet) {
  if (const auto* imu = std::get_if<RawImu>(&packet)) return ContentTime{imu->time, 0};
  if (const auto* position = std::get_if<Position>(&packet)) {
    ContentTime sent{position->time, std::nullopt};
    const bool says = position->time_passed_ms != 0 && position->time_passed_ms <= max_time_passed_ms;
    if (says) sent.send_delay_ns = position->time_passed_ms * ns_per_ms;
    return sent;
  }
  return std::nullopt;
}

ClockTrack& ClockSet::track(TimeBase base) {
  auto& found = slot(base);
  if (!found) {
    found.emplace();
    if (mapping_ == TimeMapping::fixed) found->clock = FixedClock{};
  }
  return *found;
}

bool ClockSet::observe(const ContentTime& sent, TimeNs arrival_ns) {
  ClockTrack& shown = track(sent.stamp.base);
  // Packets without a sending time count only while there are no others.
  if (!sent.send_delay_ns && shown.knows_sending) return true;
  if (sent.send_delay_ns) shown.knows_sending = true;
  return std::visit(
      [&](auto& clock) {
        const auto resets_before = clock.resets();
        clock.observe(sent.stamp, sent.send_delay_ns.value_or(typical_time_passed_ns), arrival_ns);
        return clock.resets() == resets_before;
      },
      shown.clock);
}

void ClockSet::advance_to(TimeNs now_ns) {
  for (auto& track : tracks_) {
    if (track) std::visit([now_ns](auto& clock) { clock.advance_to(now_ns); }, track->clock);
  }
}

void ClockSet::settle() {
  for (auto& track : tracks_) {
    if (!track) continue;
    std::visit(
        [](auto& clock) {
          if (!clock.settled()) clock.settle();
        },
        track->clock);
  }
}

bool ClockSet::settled() const {
  return std::all_of(tracks_.begin(), tracks_.end(), [](const auto& track) {
    return !track || std::visit([](const auto& clock) { return clock.settled(); }, track->clock);
  });
}

std::optional<TimeNs> ClockSet::settles_at_ns() const {
  std::optional<TimeNs> latest;
  for (const auto& track : tracks_) {
    if (!track) continue;
    const auto due = std::visit([](const auto& clock) { return clock.settles_at_ns(); }, track->clock);
    if (due) latest = std::max(latest.value_or(*due), *due);
  }
  return latest;
}

TimeNs ClockSet::host_ns(const Stamp& stamp) const {
  return std::visit([&stamp](const auto& clock) { return clock.host_ns(stamp); }, slot(stamp.base)->clock);
}

double ClockSet::offset_s(TimeBase base) const {
  if (!slot(base)) return 0;
  return std::visit([](const auto& clock) { return clock.offset_s(); }, slot(base)->clock);
}

double ClockSet::jitter_s(TimeBase base) const {
  if (!slot(base)) return 0;
  return std::visit([](const auto& clock) { return clock.jitter_s(); }, slot(base)->clock);
}

std::uint64_t ClockSet::resets() const {
  std::uint64_t max_resets = 0;
  for (const auto& track : tracks_) {
    if (!track) continue;
    max_resets =
        std::max(max_resets, std::visit([](const auto& clock) { return clock.resets(); }, track->clock));
  }
  return max_resets;
}

ClockSteps ClockSet::steps() const {
  ClockSteps most;
  for (const auto& track : tracks_) {
    if (!track) continue;
    const ClockSteps steps = std::visit(
        [](const auto& clock) {
          return ClockSteps{clock.steps(), clock.newest_step_ns()};
        },
        track->clock);
    if (steps.count > most.count) most = steps;
  }
  return most;
}

}  // namespace sonopose::marvelmind
