#include "faults/history_checker.hpp"

#include "faults/stall_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

namespace sonopose::faults {
namespace {

double ms(TimeNs duration_ns) {
  return static_cast<double>(duration_ns) * 1e-6;
}

/// Age of the pose's sample when it left the bridge, by the bridge's clock.
TimeNs transit_ns(const Arrival& pose) {
  return saturated_difference(pose.bridge_time_ns, pose.time_ns);
}

bool overlap(const Interval& interval, SteadyTime from, SteadyTime until) {
  return interval.from <= until && interval.until >= from;
}

}  // namespace

HistoryChecker::HistoryChecker(const History& history, const Limits& limits)
    : history_(history), limits_(limits), stalls_(merged(history.stalls)) {
  for (const BeaconAddress address : history.beacons) tracks_[address];
  for (const Published& imu : history.imu) {
    Track& track = tracks_[imu.address];
    track.index_of.emplace(imu.bridge_time_ns, track.imu.size());
    track.imu.push_back(imu);
  }
  std::set<std::pair<SteadyTime, BeaconAddress>> stops;
  for (const Arrival& pose : history.poses) {
    Track& track = tracks_[pose.address];
    const auto stop = stop_before(track, pose);
    const bool first = stop && stops.emplace(stop->from, pose.address).second;
    if (first) {
      track.in_hand.push_back(pose);
    } else {
      track.poses.push_back(pose);
    }
  }
}

/// Returns the stop of the pose's fusion between the age check and the write of this pose, if any.
std::optional<Interval> HistoryChecker::stop_before(const Track& track, const Arrival& pose) const {
  const auto sent = published(track, pose);
  for (const Episode& episode : history_.episodes) {
    const Interval& stop = episode.interval;
    if (episode.step.fault == Fault::stop && role_of(strength_of_process(pose)) == episode.step.target &&
        sent && *sent <= stop.from && pose.received >= stop.until && (pose.status & status_late) == 0U) {
      return stop;
    }
  }
  return std::nullopt;
}

Verdict HistoryChecker::check() {
  verdict_ = {};
  if (!history_.poses.empty()) {
    verdict_.stalled_ns = stalled_ns(history_.poses.front().received, history_.end);
  }
  if (tracks_.empty()) verdict_.violations.emplace_back("no sample and no pose arrived");
  for (const auto& [address, track] : tracks_) {
    check_stamps(track);
    check_ages(track);
    check_bridge_backlog(track);
    check_future(track);
    check_owners(track);
    check_late(address, track);
    check_takeover_numbers(track);
    check_silence(address, track);
    check_recovery(address, track);
  }
  check_numbers();
  return verdict_;
}

void HistoryChecker::violated(const Arrival& at, const std::string& text) {
  const SteadyTime begin = history_.episodes.empty() ? SteadyTime{} : history_.episodes.front().interval.from;
  verdict_.violations.push_back(
      fmt::format("beacon {}, {:.3f} s: {}", at.address, seconds_between(begin, at.received), text));
}

/// Strength of the fusion that wrote the pose, even if it wrote with strength 0.
std::int32_t HistoryChecker::strength_of_process(const Arrival& pose) const {
  const auto found = std::find_if(history_.statuses.begin(), history_.statuses.end(),
                                  [&](const FusionReport& report) { return report.process == pose.process; });
  return found == history_.statuses.end() ? pose.strength : found->status.strength;
}

std::string HistoryChecker::name_of(const Arrival& pose) const {
  return fmt::format("fusion-{}{}", strength_of_process(pose), pose.strength == 0 ? " (strength 0)" : "");
}

// Rising stamps of live poses

void HistoryChecker::check_stamps(const Track& track) {
  std::map<ProcessId, Arrival> latest_of;
  const Arrival* before = nullptr;
  for (const Arrival& pose : track.poses) {
    if ((pose.status & status_late) != 0U) continue;
    const auto own = latest_of.find(pose.process);
    const bool reset = own != latest_of.end() && own->second.reset_counter != pose.reset_counter;
    if (own != latest_of.end() && !reset && pose.time_ns <= own->second.time_ns) {
      violated(pose, fmt::format("the stamp of {} steps back by {:.1f} ms", name_of(pose),
                                 ms(own->second.time_ns - pose.time_ns)));
    } else if (before != nullptr && before->process != pose.process && !reset &&
               pose.time_ns < before->time_ns && !may_step_back(track, *before, pose)) {
      violated(pose, fmt::format("the stamp steps back by {:.1f} ms from {} to {}",
                                 ms(before->time_ns - pose.time_ns), name_of(*before), name_of(pose)));
    }
    latest_of[pose.process] = pose;
    before = &pose;
  }
}

/// A new owner may lag behind the old one by the samples that both have just received, i.e. those that left
/// the bridge within the takeover lag. After a silence of the bridge this is its whole backlog. If no fusion
/// serves the beacon, a stopped fusion that continues may publish its own backlog unless it is late. No
/// fusion serves while all warm up or have released the beacon in a silence.
bool HistoryChecker::may_step_back(const Track& track, const Arrival& before, const Arrival& after) const {
  if (may_be_late(after)) return true;
  const auto from = published(track, after);
  const auto until = published(track, before);
  const TimeNs lag_ns =
      from && until ? *until - *from : saturated_difference(before.bridge_time_ns, after.bridge_time_ns);
  const bool unowned =
      before.strength == 0 || after.strength == 0 || was_silent(track, before.received, after.received);
  const TimeNs max_ns = unowned ? limits_.unowned_lag_ns : limits_.takeover_lag_ns;
  return lag_ns <= max_ns + stalled_ns(before.received - lag_ns, after.received);
}

// Ages: no pose is too old or from the future

void HistoryChecker::check_ages(const Track& track) {
  std::size_t unknown = 0;
  for (const Arrival& pose : track.poses) {
    if ((pose.status & status_late) != 0U) continue;
    const auto sent = published(track, pose);
    if (!sent) {
      if (++unknown == limits_.unknown_ages + 1) violated(pose, "the samples of too many poses are unknown");
      continue;
    }
    const TimeNs age_ns = pose.received - *sent;
    verdict_.longest_age_ns = std::max(verdict_.longest_age_ns, age_ns);
    if (age_ns > limits_.age_ns + stalled_ns(*sent, pose.received)) {
      violated(pose, fmt::format("a pose of {} is {:.1f} ms old and not marked", name_of(pose), ms(age_ns)));
    }
  }
}

/// Checks that poses of a resumed bridge's backlog are marked: these samples left the bridge just now but are
/// old. A fusion that has just started (strength 0) cannot recognise its first samples as old.
void HistoryChecker::check_bridge_backlog(const Track& track) {
  for (const Arrival& pose : track.poses) {
    const bool is_marked = (pose.status & status_late) != 0U;
    if (!is_marked && pose.strength > 0 && transit_ns(pose) > limits_.transit_ns) {
      violated(pose, fmt::format("a pose of {} is not marked, but its sample was {:.1f} ms old when it left",
                                 name_of(pose), ms(transit_ns(pose))));
      return;
    }
  }
}

void HistoryChecker::check_future(const Track& track) {
  for (const Arrival& pose : track.poses) {
    const TimeNs ahead_ns = saturated_difference(pose.time_ns, pose.received_host_ns);
    if (ahead_ns > limits_.future_ns + max_ahead_ns(pose.received)) {
      violated(pose, fmt::format("a pose of {} is {:.1f} ms in the future", name_of(pose), ms(ahead_ns)));
      return;
    }
  }
}

/// Largest allowed lead of stamps, which are in the bridge's clock, over the host's clock. The line's delay
/// while the bridge synchronised with the beacon's clock adds to the lead. When the delay ends, the bridge
/// slews back up to `max_slewed_ns` and steps back the rest.
TimeNs HistoryChecker::max_ahead_ns(SteadyTime now) const {
  constexpr TimeNs settling_ns = 300'000'000;
  constexpr TimeNs max_slewed_ns = 65'000'000;
  const auto step = bridge_clock_step();
  TimeNs ahead_ns = step && now >= step->interval.from ? std::max<TimeNs>(0, step->step.amount_ns) : 0;
  for (const Life& life : history_.lives) {
    if (life.role != Role::bridge || life.interval.from > now) continue;
    ahead_ns += stalled_ns(life.interval.from - settling_ns, life.interval.from + settling_ns);
  }
  for (const Episode& episode : history_.episodes) {
    const bool is_delay = episode.step.fault == Fault::delay || episode.step.fault == Fault::reorder;
    if (!is_delay || now < episode.interval.from) continue;
    const auto settles_in_it = [&](const Life& life) {
      return life.role == Role::bridge &&
             overlap(episode.interval, life.interval.from - settling_ns, life.interval.from + settling_ns);
    };
    if (std::none_of(history_.lives.begin(), history_.lives.end(), settles_in_it)) continue;
    const bool is_over = now >= episode.interval.until + settling_ns;
    ahead_ns += is_over ? std::min(max_slewed_ns, episode.step.amount_ns) : episode.step.amount_ns;
  }
  return ahead_ns;
}

// Ownership: a beacon has one owner

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

// Silence: short while another fusion can serve

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
      violated(pose, fmt::format("no pose for {:.1f} ms beside a warm fusion", ms(silence_ns)));
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

// Lookups by time

std::optional<SteadyTime> HistoryChecker::published(const Track& track, const Arrival& pose) const {
  const auto found = track.index_of.find(pose.bridge_time_ns);
  if (found == track.index_of.end()) return std::nullopt;
  return track.imu[found->second].received;
}

bool HistoryChecker::had_episode(Role role, SteadyTime from, SteadyTime until) const {
  return std::any_of(history_.episodes.begin(), history_.episodes.end(), [&](const Episode& episode) {
    return episode.step.fault < Fault::few_descriptors && episode.step.target == role &&
           overlap(episode.interval, from, until);
  });
}

/// Allowance for lost packets of the bridge beyond the gaps that the observer sees; each reader loses others.
TimeNs HistoryChecker::loss_ns() const {
  return loses(Role::bridge) ? limits_.loss_ns : 0;
}

bool HistoryChecker::loses(Role role) const {
  return history_.plan.loss && history_.plan.loss->role == role;
}

std::optional<Episode> HistoryChecker::bridge_clock_step() const {
  for (const Episode& episode : history_.episodes) {
    if (episode.step.fault == Fault::clock_step && episode.step.target == Role::bridge) return episode;
  }
  return std::nullopt;
}

/// Interval after a backward step of the bridge's clock in which a fusion uses no samples. It ends when the
/// stamps pass the fusion's estimate, or after fifty samples, when the fusion restarts.
std::optional<Interval> HistoryChecker::backward_stamps() const {
  constexpr TimeNs slack_ns = 50'000'000;
  constexpr TimeNs samples = 50;
  const auto step = bridge_clock_step();
  if (!step || step->step.amount_ns >= 0) return std::nullopt;
  const TimeNs length_ns = std::min(-step->step.amount_ns, samples * history_.imu_period_ns) + slack_ns;
  return Interval{step->interval.from, step->interval.from + length_ns};
}

TimeNs HistoryChecker::stalled_ns(SteadyTime from, SteadyTime until) const {
  return covered_ns(stalls_, from, until);
}

}  // namespace sonopose::faults
