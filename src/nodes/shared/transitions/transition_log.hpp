#pragma once
/// \file
/// Logs changes of state, each once, and bounds how often a flapping state is logged.

#include "logging/rate_limit.hpp"
#include "transitions/line.hpp"
#include "transitions/transition.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <map>

namespace sonopose::transitions {

/// The log of all transitions; one per process. Formats, so it is not used where samples arrive. Not
/// thread-safe.
class TransitionLog {
public:
  using Write = std::function<void(const LogText&)>;

  /// Writes to the log of the process.
  TransitionLog();
  explicit TransitionLog(Write write);

  /// Logs a change at `now`. If the beacon's changes of this kind were logged too often, counts it instead,
  /// and logs the state at the end of the limit's window.
  void on(const Transition& transition, SteadyTime now);

  /// Logs and clears all pending transitions.
  void take(TransitionQueue& pending, SteadyTime now);

  /// Logs states that are due, with the number of changes left out. Call it once a second.
  void update(SteadyTime now);

  /// Logs the pending states of a beacon that is gone, and forgets it.
  void forget(BeaconAddress address);

  /// Logs all pending states at the end of the process.
  void finish();

private:
  struct Flapping {
    logging::RateLimit limit;
    Transition latest;  ///< latest transition that was left out
  };

  void report(Flapping& flapping);
  void report_dropped();

  std::map<BeaconAddress, std::array<Flapping, kind_count>> beacons_;
  Write write_;
  std::uint64_t dropped_ = 0;  ///< dropped transitions not reported yet
};

}  // namespace sonopose::transitions
