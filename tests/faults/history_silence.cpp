/// Silence: short while another fusion can serve, and over soon after the last fault.

#include "faults/history_checker.hpp"
#include "faults/history_checker_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace sonopose::faults {

void HistoryChecker::check_silence(BeaconAddress address, const Track& track) {
  const Arrival* before = nullptr;
  for (const Arrival& pose : track.poses) {
    if ((pose.status & status_late) != 0U && !may_be_late(pose)) continue;  // useless to the consumer
    const Arrival* const last = std::exchange(before, &pose);
    if (last == nullptr) continue;
    const Interval wait = wait_beside_bridge(track, last->received, pose.received);
    const TimeNs silence_ns = wait.until - wait.from;
    if (silence_ns <= 0 || !had_warm_fusion(address, wait.from, wait.until)) continue;
    verdict_.longest_silence_ns = std::max(verdict_.longest_silence_ns, silence_ns);
    const TimeNs excused_ns = stalled_ns(wait.from, wait.until) + gap_ns(track, wait) + loss_ns();
    if (silence_ns > limits_.silence_ns + excused_ns) {
      violated(pose, fmt::format("no pose for {:.1f} ms beside a warm fusion", to_ms(silence_ns)));
    }
  }
}

/// Part of the wait between two poses, counted from the due time of the second, in which the bridge sent
/// usable samples.
Interval HistoryChecker::wait_beside_bridge(const Track& track, SteadyTime from, SteadyTime until) const {
  const TimeNs pause_ns = 3 * history_.imu_period_ns;
  Interval wait{from + history_.imu_period_ns, until};
  const auto after = [](SteadyTime time, const Published& imu) { return time < imu.received; };
  const auto first = std::upper_bound(track.imu.begin(), track.imu.end(), from, after);
  const auto end = std::upper_bound(first, track.imu.end(), until, after);
  for (auto imu = first; imu != end; ++imu) {
    const bool resumes = imu == track.imu.begin() || imu->received - std::prev(imu)->received > pause_ns;
    if (resumes) wait.from = std::max(wait.from, imu->received);
  }
  const auto backward = backward_stamps();
  if (backward && overlap(*backward, wait.from, wait.until)) {
    // Keep the longer part: before the step, or after samples became usable again.
    const bool before = backward->from - wait.from > wait.until - backward->until;
    (before ? wait.until : wait.from) = before ? backward->from : backward->until;
  }
  const bool ever = end != track.imu.begin();
  wait.until = std::min(wait.until, ever ? std::prev(end)->received + pause_ns : wait.from);
  return wait;
}

/// Largest excess of the intervals between the bridge's samples over their period; the lease may end in such
/// a gap.
TimeNs HistoryChecker::gap_ns(const Track& track, Interval wait) const {
  TimeNs longest_ns = history_.imu_period_ns;
  for (std::size_t i = 1; i < track.imu.size(); ++i) {
    const Interval gap{track.imu[i - 1].received, track.imu[i].received};
    if (overlap(gap, wait.from, wait.until)) longest_ns = std::max(longest_ns, gap.until - gap.from);
  }
  return longest_ns - history_.imu_period_ns;
}

/// Returns true if the bridge and at least one warm fusion were undisturbed all the time.
bool HistoryChecker::had_warm_fusion(BeaconAddress address, SteadyTime from, SteadyTime until) const {
  constexpr TimeNs settled_ns = 300'000'000;
  constexpr TimeNs discovered_ns = 1'000'000'000;
  const auto lives_through = [&](Role role, TimeNs for_ns) {
    return std::any_of(history_.lives.begin(), history_.lives.end(), [&](const Life& life) {
      return life.role == role && life.interval.from <= from - for_ns && life.interval.until > until;
    });
  };
  if (!lives_through(Role::bridge, discovered_ns)) return false;
  for (const Role role : all_roles) {
    if (role == Role::bridge || loses(role) || !lives_through(role, settled_ns)) continue;
    if (had_episode(role, from - settled_ns, until)) continue;
    std::optional<FusionRole> latest;
    for (const FusionReport& report : history_.statuses) {
      if (report.received < from && report.status.address == address &&
          report.status.strength == strength_of(role)) {
        latest = report.status.role;
      }
    }
    if (latest == FusionRole::serving) return true;
  }
  return false;
}

// Recovery: soon after the last fault, poses flow as before

void HistoryChecker::check_recovery(BeaconAddress address, const Track& track) {
  SteadyTime fault_end{};
  for (const Episode& episode : history_.episodes) fault_end = std::max(fault_end, episode.interval.until);
  SteadyTime bad_until = fault_end;
  SteadyTime before = fault_end;
  std::string what_was_bad = "no pose at the end";
  for (const Arrival& pose : track.poses) {
    if (pose.received < fault_end) continue;
    const bool explained = may_be_late(pose);
    const std::uint32_t bad =
        status_initialising | status_stale | (explained ? 0U : std::uint32_t{status_late});
    const bool waited = pose.received - before > limits_.silence_ns + stalled_ns(before, pose.received);
    if (waited || (pose.status & bad) != 0U) {
      bad_until = pose.received;
      what_was_bad =
          waited ? fmt::format("{:.0f} ms without a pose", 1e3 * seconds_between(before, pose.received))
                 : fmt::format("a pose with status {:#x}", pose.status & bad);
    }
    before = pose.received;
  }
  const bool ended = history_.end - before > limits_.silence_ns + stalled_ns(before, history_.end);
  if (ended) bad_until = history_.end;
  const TimeNs recovery_ns = bad_until - fault_end;
  verdict_.recovery_ns = std::max(verdict_.recovery_ns, recovery_ns);
  if (ended || recovery_ns > limits_.recovery_ns + stalled_ns(fault_end, bad_until)) {
    verdict_.violations.push_back(fmt::format("beacon {}: not recovered {:.2f} s after the last fault: {}",
                                              address, seconds_between(0, recovery_ns), what_was_bad));
  }
}

}  // namespace sonopose::faults
