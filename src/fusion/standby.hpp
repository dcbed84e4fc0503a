#pragma once
/// \file
/// Which of its beacons a fusion process claims from the others that stand by: the part that decides. A claim
/// is made beacon by beacon, and given up as soon as there are no poses to serve.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

namespace sonopose::fusion {

struct StandbyOptions {
  std::int32_t strength = 1;  ///< ≥ 1; 0 is what every process has while it warms up
  double warm_up_s = 5.0;     ///< for how long a beacon's pose must have been good before it is claimed
};

/// Roles of all beacons. Not for several threads at once: no locks. Allocates at a beacon's first pose alone.
class Standby {
public:
  /// However bad its pose stays, a beacon is claimed after so many warm-up times: the others' is no better.
  static constexpr double most_warm_ups = 6.0;

  /// `stall_ns`: a beacon without a pose for so long is given up.
  Standby(const StandbyOptions& options, TimeNs stall_ns);

  /// What to do with a pose.
  struct Step {
    FusionRole role = FusionRole::warming;  ///< whose strength it is written with
    bool give_up = false;                   ///< take the claim back first
  };

  /// A pose that is about to be written at `now`, whose sample the bridge published
  /// `age_ns` ago (by clocks that need not agree). After a stall the beacon is claimed again with its first
  /// good pose where the input was silent; where its samples come later than they used to, this process was
  /// held up, has missed some, and warms up anew.
  Step on_pose(BeaconAddress address, std::uint32_t status, TimeNs age_ns, SteadyTime now);

  /// Adds to `stalled` the beacons whose claim must be taken back at `now`. Each is named again at the
  /// next call, and so is one that on_pose gave up: for a pose that was on its way just then.
  void find_stalled(SteadyTime now, std::vector<BeaconAddress>& stalled);

  /// When find_stalled has something to say if no pose comes; the largest time where never.
  [[nodiscard]] SteadyTime next_stall() const;

  /// From now on nothing is claimed: the others shall take over while this process still serves.
  void step_down() { stepping_down_ = true; }

  /// Of a beacon never heard of: warming.
  [[nodiscard]] FusionRole role(BeaconAddress address) const;

private:
  struct Lane {
    FusionRole role = FusionRole::warming;
    SteadyTime latest;         ///< of the last pose
    SteadyTime warming_since;  ///< first pose of this warm-up
    SteadyTime good_since;     ///< first good pose of the present run of them; 0: the last was bad
    TimeNs least_age_ns = std::numeric_limits<TimeNs>::max();
    TimeNs age_ns = 0;  ///< of the last pose's sample
    bool warm = false;  ///< it has been claimed, and missed nothing since
    bool name_again = false;
  };

  [[nodiscard]] bool is_warm(const Lane& lane, SteadyTime now) const;
  [[nodiscard]] bool is_late(const Lane& lane) const;
  void begin_warm_up(Lane& lane, SteadyTime now) const;

  TimeNs warm_up_ns_;
  TimeNs stall_ns_;
  bool stepping_down_ = false;
  std::unordered_map<BeaconAddress, Lane> lanes_;
};

}  // namespace sonopose::fusion
