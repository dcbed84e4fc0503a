/// Accounting: every missing number is counted.

#include "faults/history_checker.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::faults {
namespace {

std::uint64_t reduced(std::uint64_t count, std::uint64_t by) {
  return count - std::min(count, by);
}

/// Losses that a fusion counts per beacon.
std::uint64_t losses_of_beacon(const FusionStatus& status) {
  return status.events_lost + status.samples_invalid + status.poses_skipped;
}

/// Losses that a fusion counts for all beacons together.
std::uint64_t losses_of_process(const FusionStatus& status) {
  return status.samples_lost + status.samples_rejected + status.poses_unwritten;
}

/// Rise of a counter over the reports selected by `concerns`, since the first pose of the history.
template <class Concerns, class Counter>
std::uint64_t rise(const History& history, const Concerns& concerns, const Counter& counter) {
  std::uint64_t before = 0;
  std::uint64_t latest = 0;
  for (const FusionReport& report : history.statuses) {
    if (!concerns(report)) continue;
    latest = counter(report.status);
    if (report.received < history.poses.front().received) before = latest;
  }
  return reduced(latest, before);
}

}  // namespace

/// Checks changes of the owner. Missing samples are explained by the consumer's notice of the owner's loss,
/// or by the lag between the fusions.
void HistoryChecker::check_takeover_numbers(const Track& track) {
  for (std::size_t i = 1; i < track.poses.size(); ++i) {
    const Arrival& before = track.poses[i - 1];
    const Arrival& after = track.poses[i];
    const std::uint64_t missing = missing_between(track, before, after);
    if (before.process == after.process || missing == 0) continue;
    const auto from = published(track, before);
    const auto until = published(track, after);
    const bool lag =
        from && until && *until - *from <= limits_.takeover_lag_ns + stalled_ns(*from, after.received);
    const bool known = lag || may_weaken(track, before, after);
    (known ? verdict_.missing_counted : verdict_.missing_uncounted) += missing;
    if (known) continue;
    violated(after, fmt::format("{} samples have no pose at a takeover that nothing explains", missing));
  }
}

/// Checks that samples missing beyond the beacons' own counters are in those of the process, once for all
/// beacons.
void HistoryChecker::check_numbers() {
  struct Missing {
    std::uint64_t count = 0;
    std::uint64_t beyond_beacons = 0;  ///< samples that their beacon's counters do not cover
    Arrival latest;
  };
  std::map<ProcessId, Missing> missing_of;
  for (const auto& [address, track] : tracks_) {
    std::map<ProcessId, std::uint64_t> of_beacon;
    for (std::size_t i = 1; i < track.poses.size(); ++i) {
      const Arrival& after = track.poses[i];
      const std::uint64_t missing = missing_between(track, track.poses[i - 1], after);
      if (track.poses[i - 1].process != after.process || missing == 0 || !has_report_after(after)) continue;
      of_beacon[after.process] += missing;
      missing_of[after.process].latest = after;
    }
    for (const auto& [process, count] : of_beacon) {
      const auto of_it = [&, id = process, beacon = address](const FusionReport& report) {
        return report.process == id && report.status.address == beacon;
      };
      missing_of[process].count += count;
      missing_of[process].beyond_beacons += reduced(count, rise(history_, of_it, losses_of_beacon));
    }
  }
  std::uint64_t of_consumer =
      history_.consumer_lost + history_.consumer_rejected;  // the consumer does not know whose
  for (const auto& [process, missing] : missing_of) {
    const auto of_it = [id = process](const FusionReport& report) { return report.process == id; };
    const std::uint64_t beyond_process =
        reduced(missing.beyond_beacons, rise(history_, of_it, losses_of_process));
    const std::uint64_t uncounted = reduced(beyond_process, of_consumer);
    of_consumer -= beyond_process - uncounted;
    verdict_.missing_counted += missing.count - uncounted;
    verdict_.missing_uncounted += uncounted;
    if (uncounted == 0) continue;
    violated(missing.latest, fmt::format("{} samples have no pose of {}, and {} of them nothing counted",
                                         missing.count, name_of(missing.latest), uncounted));
  }
}

std::uint64_t HistoryChecker::missing_between(const Track& track, const Arrival& before,
                                              const Arrival& after) const {
  const auto from = track.index_of.find(before.bridge_time_ns);
  const auto until = track.index_of.find(after.bridge_time_ns);
  if (from == track.index_of.end() || until == track.index_of.end()) return 0;
  const auto is_between = [&](const Arrival& pose) {
    if (pose.process != before.process && pose.process != after.process) return false;
    const auto found = track.index_of.find(pose.bridge_time_ns);
    return found != track.index_of.end() && found->second > from->second && found->second < until->second;
  };
  const auto in_hand = std::count_if(track.in_hand.begin(), track.in_hand.end(), is_between);
  return reduced(until->second, from->second + 1 + static_cast<std::uint64_t>(in_hand));
}

/// Returns true if the process lived long enough to report the beacon's losses up to this pose.
bool HistoryChecker::has_report_after(const Arrival& pose) const {
  return std::any_of(history_.statuses.begin(), history_.statuses.end(), [&](const FusionReport& report) {
    return report.process == pose.process && report.status.address == pose.address &&
           report.received > pose.received;
  });
}

}  // namespace sonopose::faults
