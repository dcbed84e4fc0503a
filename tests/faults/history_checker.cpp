#include "faults/history_checker.hpp"

#include "faults/history_checker_parts.hpp"
#include "faults/stall_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace sonopose::faults {

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
    check_stamp_ages(track);
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
