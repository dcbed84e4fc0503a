#include "fusion/standby.hpp"

#include <algorithm>

namespace sonopose::fusion {

Standby::Standby(const StandbyOptions& options, TimeNs stall_ns)
    : warm_up_ns_(to_ns(options.warm_up_s)), stall_ns_(stall_ns) {}

Standby::Step Standby::on_pose(BeaconAddress address, std::uint32_t status, TimeNs late_ns, SteadyTime now) {
  const auto [found, is_new] = claims_.try_emplace(address);
  BeaconClaim& claim = found->second;
  const bool claimed = claim.role == FusionRole::serving;
  claim.late_ns = late_ns;
  if (is_new || claim.role == FusionRole::stalled || now - claim.latest > stall_ns_) {
    if (is_late(claim)) claim.warm = false;
    begin_warm_up(claim, now);
    claim.backlog = is_late(claim) ? std::optional(Backlog{late_ns, now}) : std::nullopt;
  }
  claim.latest = now;
  constexpr TimeNs min_fall_ns = 5'000'000;
  if (claim.backlog && late_ns <= claim.backlog->late_ns - min_fall_ns) claim.backlog = {late_ns, now};
  constexpr std::uint32_t bad = status_initialising | status_converging | status_imu_gap;
  if ((status & bad) != 0U) {
    claim.good_since = SteadyTime{};
  } else if (claim.good_since == SteadyTime{}) {
    claim.good_since = now;
  }
  if (stepping_down_) {
    claim.role = FusionRole::warming;
  } else if (claim.role != FusionRole::serving && is_warm(claim, now) && !is_late(claim)) {
    claim.role = FusionRole::serving;
    claim.warm = true;
  }
  const bool release = claimed && claim.role != FusionRole::serving;
  claim.relist = claim.relist || release;
  return {claim.role, release, is_backlog(claim, now)};
}

/// True while a backlog is taken: samples arrive in one burst, each less late than the previous one. Samples
/// delayed on their way, or by a clock that was set back, come one by one and equally late. The last
/// samples of a backlog are skipped too, since current poses follow shortly.
bool Standby::is_backlog(const BeaconClaim& claim, SteadyTime now) const {
  if (claim.role == FusionRole::serving || !claim.backlog) return false;
  return now - claim.backlog->at < stall_ns_ / (is_late(claim) ? 4 : 20);
}

/// True if samples are delayed on their way to this process: other fusions have newer poses.
bool Standby::is_late(const BeaconClaim& claim) const {
  return claim.late_ns > stall_ns_ / 4;
}

bool Standby::is_warm(const BeaconClaim& claim, SteadyTime now) const {
  const bool good = claim.good_since != SteadyTime{} && (claim.warm || now - claim.good_since >= warm_up_ns_);
  const auto timeout_ns = static_cast<TimeNs>(max_warm_ups * static_cast<double>(warm_up_ns_));
  return good || now - claim.warming_since > timeout_ns;
}

void Standby::begin_warm_up(BeaconClaim& claim, SteadyTime now) const {
  claim.role = FusionRole::warming;
  claim.warming_since = now;
  claim.good_since = SteadyTime{};
}

void Standby::find_stalled(SteadyTime now, std::vector<BeaconAddress>& stalled) {
  for (auto& [address, claim] : claims_) {
    if (claim.relist) {
      claim.relist = false;
      if (claim.role != FusionRole::serving) stalled.push_back(address);
    } else if (claim.role != FusionRole::stalled && now - claim.latest > stall_ns_) {
      claim.role = FusionRole::stalled;
      claim.relist = true;
      stalled.push_back(address);
    }
  }
}

SteadyTime Standby::next_stall() const {
  SteadyTime next = SteadyTime::max();
  for (const auto& entry : claims_) {
    const BeaconClaim& claim = entry.second;
    if (claim.role != FusionRole::stalled) next = std::min(next, claim.latest + stall_ns_ + 1);
  }
  return next;
}

FusionRole Standby::role(BeaconAddress address) const {
  const auto found = claims_.find(address);
  return found == claims_.end() ? FusionRole::warming : found->second.role;
}

}  // namespace sonopose::fusion
