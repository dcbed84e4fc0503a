#pragma once
/// \file
/// Counts since the start of the monitor; counters in statuses start with their own processes.

#include "observation/beacon_observer.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace sonopose::monitor {

class CountersSince {
public:
  /// Replaces the counters of the views by their increases. `running_s`: time since the start of the monitor.
  /// A bridge or fusion that appears in the first five seconds ran before, and counts from then on. One that
  /// appears later, or has restarted, counts from its own start.
  void apply(std::vector<observation::BeaconView>& views, double running_s);

  /// Sets the counters of these received views to zero.
  void clear(const std::vector<observation::BeaconView>& received);

private:
  /// Bounds the memory: each restart of a fusion has a new id.
  void forget_ended_fusions(const std::vector<observation::BeaconView>& views);

  struct Own {
    std::uint64_t deadlines_missed = 0;
    std::uint64_t losses = 0;
  };

  std::map<BeaconAddress, BeaconStatus> bridges_;
  std::map<std::pair<BeaconAddress, std::uint64_t>, FusionStatus> fusions_;  ///< by address and fusion_id
  std::map<BeaconAddress, Own> own_;  ///< counters of the monitor itself
};

}  // namespace sonopose::monitor
