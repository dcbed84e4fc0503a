#include "fusion/standby.hpp"

#include <algorithm>
#include <limits>

namespace sonopose::fusion {

Standby::Standby(const StandbyOptions& options, TimeNs stall_ns)
    : warm_up_ns_(to_ns(options.warm_up_s)), stall_ns_(stall_ns) {}

Standby::Step Standby::on_pose(BeaconAddress address, std::uint32_t status, TimeNs late_ns, SteadyTime now) {
  const auto [found, is_new] = lanes_.try_emplace(address);
  Lane& lane = found->second;
  const bool claimed = lane.role == FusionRole::serving;
  lane.late_ns = late_ns;
  if (is_new || lane.role == FusionRole::stalled || now - lane.latest > stall_ns_) {
    if (is_late(lane)) lane.warm = false;
    begin_warm_up(lane, now);
    lane.backlog = is_late(lane) ? std::optional(Backlog{late_ns, now}) : std::nullopt;
  }
  lane.latest = now;
  constexpr TimeNs least_fall_ns = 5'000'000;
  if (lane.backlog && late_ns <= lane.backlog->late_ns - least_fall_ns) lane.backlog = {late_ns, now};
  constexpr std::uint32_t bad = status_initialising | status_converging | status_imu_gap;
  if ((status & bad) != 0U) {
    lane.good_since = SteadyTime{};
  } else if (lane.good_since == SteadyTime{}) {
    lane.good_since = now;
  }
  if (stepping_down_) {
    lane.role = FusionRole::warming;
  } else if (lane.role != FusionRole::serving && is_warm(lane, now) && !is_late(lane)) {
    lane.role = FusionRole::serving;
    lane.warm = true;
  }
  const bool release = claimed && lane.role != FusionRole::serving;
  lane.list_again = lane.list_again || release;
  return {lane.role, release, is_backlog(lane, now)};
}

/// A backlog is taken at once, each sample less late than the one before. Samples that are delayed on their
/// way, and those of a clock that was set back, come one by one and equally late. The end of a backlog is
/// skipped too, but briefly: it is followed by poses as usual.
bool Standby::is_backlog(const Lane& lane, SteadyTime now) const {
  if (lane.role == FusionRole::serving || !lane.backlog) return false;
  return now - lane.backlog->at < stall_ns_ / (is_late(lane) ? 4 : 20);
}

/// Samples are delayed on their way to this process: its poses would be older than those of the others.
bool Standby::is_late(const Lane& lane) const {
  return lane.late_ns > stall_ns_ / 4;
}

bool Standby::is_warm(const Lane& lane, SteadyTime now) const {
  const bool good = lane.good_since != SteadyTime{} && (lane.warm || now - lane.good_since >= warm_up_ns_);
  const auto timeout_ns = static_cast<TimeNs>(most_warm_ups * static_cast<double>(warm_up_ns_));
  return good || now - lane.warming_since > timeout_ns;
}

void Standby::begin_warm_up(Lane& lane, SteadyTime now) const {
  lane.role = FusionRole::warming;
  lane.warming_since = now;
  lane.good_since = SteadyTime{};
}

void Standby::find_stalled(SteadyTime now, std::vector<BeaconAddress>& stalled) {
  for (auto& [address, lane] : lanes_) {
    if (lane.list_again) {
      lane.list_again = false;
      if (lane.role != FusionRole::serving) stalled.push_back(address);
    } else if (lane.role != FusionRole::stalled && now - lane.latest > stall_ns_) {
      lane.role = FusionRole::stalled;
      lane.list_again = true;
      stalled.push_back(address);
    }
  }
}

SteadyTime Standby::next_stall() const {
  SteadyTime next = SteadyTime::max();
  for (const auto& entry : lanes_) {
    const Lane& lane = entry.second;
    if (lane.role != FusionRole::stalled) next = std::min(next, lane.latest + stall_ns_ + 1);
  }
  return next;
}

FusionRole Standby::role(BeaconAddress address) const {
  const auto found = lanes_.find(address);
  return found == lanes_.end() ? FusionRole::warming : found->second.role;
}

}  // namespace sonopose::fusion
