#pragma once
/// \file
/// Detects beacons without samples on the reader's side. DDS alone does not detect a writer that is alive and
/// keeps its ownership but no longer writes one of its beacons.

#include <sonopose/samples/samples.hpp>

#include <unordered_map>
#include <vector>

namespace sonopose::process {

/// All beacons of one stream. Not thread-safe. Allocates at a beacon's first sample only.
class SilenceDetector {
public:
  /// `deadline_ns`: a beacon without a sample for longer than this is silent.
  explicit SilenceDetector(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  void on_sample(BeaconAddress address, SteadyTime now) { beacons_[address].latest = now; }

  struct Change {
    BeaconAddress address = 0;
    bool silent = false;
    double lasted_s = 0;  ///< how long the silence has lasted, or lasted until the next sample
  };
  /// Appends to `changes` the beacons that fell silent or resumed since the last call.
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
