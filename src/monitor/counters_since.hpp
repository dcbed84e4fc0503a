#pragma once
/// \file
/// Counters since the start of the monitor: those of the statuses start with their own processes.

#include "observation/beacon_observer.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace sonopose::monitor {

class CountersSince {
public:
  /// Replaces the counters of the views by what they have increased by. `running_s`: since the start of the
  /// monitor. A bridge or fusion that appears in the first five seconds was there before, and counts from now
  /// on; one that appears later, or that has restarted, counts from its own start.
  void apply(std::vector<observation::BeaconView>& views, double running_s);

  /// The counters of these views, as they are received, become zero.
  void clear(const std::vector<observation::BeaconView>& received);

private:
  /// Each start of a fusion has a new id: a fusion that restarts again and again must not fill the memory.
  void forget_ended_fusions(const std::vector<observation::BeaconView>& views);

  struct Own {
    std::uint64_t deadlines_missed = 0;
    std::uint64_t losses = 0;
  };

  std::map<BeaconAddress, BeaconStatus> bridges_;
  std::map<std::pair<BeaconAddress, std::uint64_t>, FusionStatus> fusions_;  ///< by address and fusion_id
  std::map<BeaconAddress, Own> own_;  ///< what the monitor counts itself
};

}  // namespace sonopose::monitor
