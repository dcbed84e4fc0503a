#pragma once
/// \file
/// Decides which beacons a fusion process claims among several that stand by for each other. Each beacon is
/// claimed separately, and released as soon as it has no poses.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace sonopose::fusion {

struct StandbyOptions {
  std::int32_t strength = 1;  ///< ≥ 1; every process has 0 while it warms up
  double warm_up_s = 5.0;     ///< duration of good poses before a claim
};

/// Roles for all beacons. Not thread-safe. Allocates only at a beacon's first pose.
class Standby {
public:
  /// Warm-up times after which a beacon is claimed even with a bad pose: the others have no better one.
  static constexpr double max_warm_ups = 6.0;

  /// `stall_ns`: time without a pose after which a beacon is released.
  Standby(const StandbyOptions& options, TimeNs stall_ns);

  /// Treatment of a pose.
  struct Step {
    FusionRole role = FusionRole::warming;  ///< determines the ownership strength of the pose
    bool release = false;                   ///< release the beacon first
    bool skip = false;                      ///< do not write the pose: it belongs to the backlog of a pause
  };

  /// Judges a pose to be written at `now`, whose sample arrived `late_ns` later than usual. If only the input
  /// was silent, a stalled beacon is claimed again with its first good pose. If its samples are late, this
  /// process was suspended and has missed samples: the beacon warms up again, and the burst of late poses is
  /// skipped. Otherwise, while the beacon has no owner, consumers would receive them beside those of another
  /// fusion.
  Step on_pose(BeaconAddress address, std::uint32_t status, TimeNs late_ns, SteadyTime now);

  /// Adds to `stalled` the beacons to release at `now`. Each of them, and each that on_pose released, is
  /// listed twice, in case a pose was being written at the time.
  void find_stalled(SteadyTime now, std::vector<BeaconAddress>& stalled);

  /// Next time at which find_stalled finds a beacon without further poses; SteadyTime::max() if never.
  [[nodiscard]] SteadyTime next_stall() const;

  /// Stops claiming, so that others take over while this process still runs.
  void step_down() { stepping_down_ = true; }

  void forget(BeaconAddress address) { claims_.erase(address); }

  /// Role for a beacon; warming for an unknown one.
  [[nodiscard]] FusionRole role(BeaconAddress address) const;

private:
  /// Progress through the backlog before this warm-up: the latest sample clearly less late than those before,
  /// and the time of its pose.
  struct Backlog {
    TimeNs late_ns = 0;
    SteadyTime at;
  };

  struct BeaconClaim {
    FusionRole role = FusionRole::warming;
    SteadyTime latest;               ///< time of the last pose
    SteadyTime warming_since;        ///< time of the first pose of this warm-up
    SteadyTime good_since;           ///< first good pose of the current run; 0: the last was bad
    TimeNs late_ns = 0;              ///< lateness of the last pose's sample
    std::optional<Backlog> backlog;  ///< empty: the first sample was in time
    bool warm = false;               ///< was claimed and has missed no samples since
    bool relist = false;             ///< true if the release is listed a second time
  };

  [[nodiscard]] bool is_warm(const BeaconClaim& claim, SteadyTime now) const;
  [[nodiscard]] bool is_late(const BeaconClaim& claim) const;
  [[nodiscard]] bool is_backlog(const BeaconClaim& claim, SteadyTime now) const;
  void begin_warm_up(BeaconClaim& claim, SteadyTime now) const;

  TimeNs warm_up_ns_;
  TimeNs stall_ns_;
  bool stepping_down_ = false;
  std::unordered_map<BeaconAddress, BeaconClaim> claims_;
};

}  // namespace sonopose::fusion
