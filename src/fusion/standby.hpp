#pragma once
/// \file
/// Decides which beacons a fusion process claims among several that stand by for each other. Each beacon is
/// claimed separately, and released as soon as it has no poses.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace sonopose::fusion {

struct StandbyOptions {
  std::int32_t strength = 1;  ///< ≥ 1; every process has 0 while it warms up
  double warm_up_s = 5.0;     ///< duration of good poses before a beacon is claimed
};

/// The roles for all beacons. Not thread-safe. Allocates only at a beacon's first pose.
class Standby {
public:
  /// Warm-up times after which a beacon is claimed even with a bad pose: the others have no better one.
  static constexpr double most_warm_ups = 6.0;

  /// `stall_ns`: a beacon without a pose for this long is released.
  Standby(const StandbyOptions& options, TimeNs stall_ns);

  /// What to do with a pose.
  struct Step {
    FusionRole role = FusionRole::warming;  ///< determines the strength that the pose is written with
    bool release = false;                   ///< release the beacon first
    bool skip = false;                      ///< do not write it: it is of the backlog of a pause
  };

  /// A pose that is about to be written at `now`, whose sample arrived `late_ns` later than usual. If the
  /// input was silent, a stalled beacon is claimed again with its first good pose. If its samples are late,
  /// this process was suspended and has missed samples: it warms up again, and the late poses that follow at
  /// once are skipped. While the beacon has no owner, consumers would receive them beside those of another
  /// fusion.
  Step on_pose(BeaconAddress address, std::uint32_t status, TimeNs late_ns, SteadyTime now);

  /// Adds to `stalled` the beacons to release at `now`. Each, and each that
  /// on_pose released, is listed twice, in case a pose was being written at the time.
  void find_stalled(SteadyTime now, std::vector<BeaconAddress>& stalled);

  /// The next time at which find_stalled finds a beacon without further poses; SteadyTime::max() if never.
  [[nodiscard]] SteadyTime next_stall() const;

  /// Claims nothing from now on, so that others take over while this process still runs.
  void step_down() { stepping_down_ = true; }

  void forget(BeaconAddress address) { lanes_.erase(address); }

  /// The role for a beacon; warming for an unknown one.
  [[nodiscard]] FusionRole role(BeaconAddress address) const;

private:
  /// How far the samples that gathered before this warm-up are taken: the latest one that was clearly less
  /// late than those before, and when its pose came.
  struct Backlog {
    TimeNs late_ns = 0;
    SteadyTime at;
  };

  struct Lane {
    FusionRole role = FusionRole::warming;
    SteadyTime latest;               ///< of the last pose
    SteadyTime warming_since;        ///< first pose of this warm-up
    SteadyTime good_since;           ///< first good pose of the present run of them; 0: the last was bad
    TimeNs late_ns = 0;              ///< of the last pose's sample
    std::optional<Backlog> backlog;  ///< empty: the first sample was in time
    bool warm = false;               ///< it was claimed and has missed no samples since
    bool list_again = false;
  };

  [[nodiscard]] bool is_warm(const Lane& lane, SteadyTime now) const;
  [[nodiscard]] bool is_late(const Lane& lane) const;
  [[nodiscard]] bool is_backlog(const Lane& lane, SteadyTime now) const;
  void begin_warm_up(Lane& lane, SteadyTime now) const;

  TimeNs warm_up_ns_;
  TimeNs stall_ns_;
  bool stepping_down_ = false;
  std::unordered_map<BeaconAddress, Lane> lanes_;
};

}  // namespace sonopose::fusion
