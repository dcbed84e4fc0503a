#pragma once
/// \file
/// Logs changes of state, each once, and bounds how often a flapping state is logged.

#include "transitions/line.hpp"
#include "transitions/rate_limit.hpp"
#include "transitions/transition.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <map>

namespace sonopose::transitions {

/// One per process. Formats, so it is not used where samples arrive. Not thread-safe.
class TransitionLog {
public:
  using Write = std::function<void(const Line&)>;

  /// Writes to the log of the process.
  TransitionLog();
  explicit TransitionLog(Write write);

  /// Logs a change at `now`, unless the beacon's changes of this kind were logged too often: then it is
  /// counted, and the state is logged after the limit's time.
  void on(const Transition& transition, SteadyTime now);

  /// Logs all that is pending, and clears it.
  void take(Pending& pending, SteadyTime now);

  /// Logs the states that were not logged in time, with the number of changes left out. Call it once a
  /// second.
  void update(SteadyTime now);

  /// A beacon is gone. Logs what was not logged of it.
  void forget(BeaconAddress address);

  /// The process ends: logs what was not logged in time.
  void finish();

private:
  struct Flapping {
    RateLimit limit;
    Transition latest;  ///< that was left out
  };

  void report(Flapping& flapping);
  void report_dropped();

  std::map<BeaconAddress, std::array<Flapping, kind_count>> beacons_;
  Write write_;
  std::uint64_t dropped_ = 0;  ///< not reported yet
};

}  // namespace sonopose::transitions
