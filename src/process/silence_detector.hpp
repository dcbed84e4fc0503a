#pragma once
/// \file
/// A reader's own timer: which beacons have brought nothing for too long. The middleware cannot tell where a
/// writer lives, holds its claim, and no longer writes one of its beacons.

#include <sonopose/samples/samples.hpp>

#include <unordered_map>
#include <vector>

namespace sonopose::process {

/// All beacons of one stream. Times are of the steady clock. Not for several threads at once: no locks.
/// Allocates at a beacon's first sample alone.
class SilenceDetector {
public:
  /// `deadline_ns`: a beacon without a sample for longer is silent.
  explicit SilenceDetector(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  void on_sample(BeaconAddress address, SteadyTime now) { beacons_[address].latest = now; }

  struct Change {
    BeaconAddress address = 0;
    bool silent = false;
    double lasted_s = 0;  ///< silent: for how long already; heard again: how long the silence was
  };
  /// Adds to `changes` what fell silent or was heard again since the last call.
  void find_changes(SteadyTime now, std::vector<Change>& changes);

  [[nodiscard]] bool is_silent(BeaconAddress address) const;

private:
  struct Beacon {
    SteadyTime latest;
    bool silent = false;
    SteadyTime silent_since;
  };
  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, Beacon> beacons_;
};

}  // namespace sonopose::process
