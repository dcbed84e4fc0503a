/// Times: stamps rise, and no pose is too old or from the future.

#include "faults/history_checker.hpp"
#include "faults/history_checker_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace sonopose::faults {

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
                                 to_ms(own->second.time_ns - pose.time_ns)));
    } else if (before != nullptr && before->process != pose.process && !reset &&
               pose.time_ns < before->time_ns && !may_step_back(track, *before, pose)) {
      violated(pose, fmt::format("the stamp steps back by {:.1f} ms from {} to {}",
                                 to_ms(before->time_ns - pose.time_ns), name_of(*before), name_of(pose)));
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

// Ages

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
      violated(pose,
               fmt::format("a pose of {} is {:.1f} ms old and not marked", name_of(pose), to_ms(age_ns)));
    }
  }
}

/// Checks that poses of old samples are marked, wherever the samples were delayed. By the bridge's clock they
/// are old when they leave a bridge that was stopped.
void HistoryChecker::check_stamp_ages(const Track& track) {
  const auto step = bridge_clock_step();
  bool is_violated = false;
  const auto violated_once = [&](const Arrival& pose, const std::string& text) {
    if (!std::exchange(is_violated, true)) {
      violated(pose, fmt::format("a pose of {} is not marked, but its {}", name_of(pose), text));
    }
  };
  for (const Arrival& pose : track.poses) {
    if ((pose.status & status_late) != 0U) continue;
    if (transit_ns(pose) > limits_.transit_ns) {
      violated_once(pose, fmt::format("sample was {:.1f} ms old when it left", to_ms(transit_ns(pose))));
    }
    const bool is_stepped = step && pose.received >= step->interval.from;
    const TimeNs unknown_ns = limits_.clock_step_late_ns + verdict_.stalled_ns;
    if (is_stepped && pose.received <= step->interval.from + unknown_ns) continue;
    const TimeNs ahead_ns = is_stepped ? step->step.amount_ns : 0;  // the bridge's clock, of the host's
    const TimeNs age_ns = saturated_difference(pose.received_host_ns, pose.time_ns) + ahead_ns;
    if (age_ns <= limits_.age_ns) continue;
    ++verdict_.old_poses;
    if (age_ns > limits_.age_ns + stalled_ns(pose.received - age_ns, pose.received)) {
      violated_once(pose, fmt::format("stamp is {:.1f} ms old", to_ms(age_ns)));
    }
  }
}

void HistoryChecker::check_future(const Track& track) {
  for (const Arrival& pose : track.poses) {
    const TimeNs ahead_ns = saturated_difference(pose.time_ns, pose.received_host_ns);
    if (ahead_ns > limits_.future_ns + max_ahead_ns(pose.received)) {
      violated(pose, fmt::format("a pose of {} is {:.1f} ms in the future", name_of(pose), to_ms(ahead_ns)));
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

}  // namespace sonopose::faults
