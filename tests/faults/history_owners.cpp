/// Ownership: a beacon has one owner, and a resumed fusion does not send its backlog beside it.

#include "faults/history_checker.hpp"
#include "faults/history_checker_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>

namespace sonopose::faults {

void HistoryChecker::check_owners(const Track& track) {
  for (std::size_t i = 1; i < track.poses.size(); ++i) {
    const Arrival& before = track.poses[i - 1];
    const Arrival& after = track.poses[i];
    if (before.process == after.process) continue;
    ++verdict_.owner_changes;
    if (after.strength >= before.strength || may_weaken(track, before, after)) continue;
    violated(after,
             fmt::format("{} is received although {} owns the beacon", name_of(after), name_of(before)));
  }
}

/// Returns true if a weaker fusion may be received: the stronger one lost its lease, was taken out, or
/// released the beacon for lack of samples.
bool HistoryChecker::may_weaken(const Track& track, const Arrival& before, const Arrival& after) const {
  // Another thread records the loss.
  const TimeNs notice_ns = 20'000'000 + stalled_ns(before.received, after.received + 1'000'000'000);
  const auto is_loss = [&](const LivelinessLoss& loss) {
    return loss.writer == before.writer && loss.at >= before.received &&
           loss.at <= after.received + notice_ns;
  };
  if (std::any_of(history_.losses.begin(), history_.losses.end(), is_loss)) return true;
  const auto role = role_of(before.strength);
  if (role && (had_episode(*role, before.received, after.received) || loses(*role))) return true;
  const SteadyTime from = before.received - 2 * limits_.lease_ns;
  return was_silent(track, from, after.received) || stalled_ns(from, after.received) >= limits_.lease_ns / 2;
}

/// Returns true if the beacon's samples paused, or were unusable, long enough for a fusion to release it.
bool HistoryChecker::was_silent(const Track& track, SteadyTime from, SteadyTime until) const {
  const auto backward = backward_stamps();
  if (backward && overlap(*backward, from, until)) return true;
  const TimeNs release_ns = limits_.lease_ns * 9 / 10 - loss_ns();
  for (std::size_t i = 1; i < track.imu.size(); ++i) {
    const Interval pause{track.imu[i - 1].received, track.imu[i].received};
    if (pause.until - pause.from >= release_ns && overlap(pause, from, until)) return true;
  }
  return false;
}

// Backlog of a resumed fusion: not received while another one serves

/// Allows one late pose per stop: the one that the fusion was about to write.
void HistoryChecker::check_late(BeaconAddress address, const Track& track) {
  std::map<ProcessId, std::size_t> late_of;
  for (const Arrival& pose : track.poses) {
    if ((pose.status & status_late) == 0U || may_be_late(pose)) continue;
    if (transit_ns(pose) > limits_.prompt_transit_ns) continue;
    if (!had_warm_fusion(address, pose.received - limits_.lease_ns, pose.received)) continue;
    if (stalled_ns(pose.received - limits_.late_after_ns, pose.received) >= limits_.lease_ns / 2) continue;
    const auto stops =
        std::count_if(history_.episodes.begin(), history_.episodes.end(), [&](const Episode& episode) {
          return episode.step.fault == Fault::stop &&
                 role_of(strength_of_process(pose)) == episode.step.target;
        });
    if (++late_of[pose.process] == std::max<std::size_t>(1, static_cast<std::size_t>(stops)) + 1) {
      violated(pose, fmt::format("poses of {} are late beside a warm fusion", name_of(pose)));
    }
  }
}

/// Returns true shortly after a step of the bridge's clock, when any pose may be late.
bool HistoryChecker::may_be_late(const Arrival& pose) const {
  const auto step = bridge_clock_step();
  return step && pose.received >= step->interval.from &&
         pose.received - step->interval.from < limits_.clock_step_late_ns;
}

}  // namespace sonopose::faults
