#pragma once
/// \file
/// Detects beacons without samples on the reader's side. DDS alone does not detect a writer that is alive and
/// keeps its ownership but no longer writes one of its beacons.

#include <sonopose/samples/samples.hpp>

#include <optional>
#include <unordered_map>
#include <vector>

namespace sonopose::process {

/// The silence of one stream of one beacon. Not thread-safe.
class Silence {
public:
  void on_sample(SteadyTime now) { latest_ = now; }

  struct Change {
    bool silent = false;
    double lasted_s = 0;  ///< how long the silence has lasted, or lasted until the next sample
  };
  /// Returns whether the stream fell silent or resumed since the last call. It is silent without a sample for
  /// longer than `deadline_ns`, never before its first sample.
  std::optional<Change> find_change(SteadyTime now, TimeNs deadline_ns);

  [[nodiscard]] bool is_silent() const { return silent_; }

private:
  std::optional<SteadyTime> latest_;
  bool silent_ = false;
  SteadyTime silent_since_;
};

/// All beacons of one stream. Not thread-safe. Allocates at a beacon's first sample only.
class SilenceDetector {
public:
  /// `deadline_ns`: a beacon without a sample for longer than this is silent.
  explicit SilenceDetector(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  void on_sample(BeaconAddress address, SteadyTime now) { beacons_[address].on_sample(now); }

  struct Change : Silence::Change {
    BeaconAddress address = 0;
  };
  /// Appends to `changes` the beacons that fell silent or resumed since the last call.
  void find_changes(SteadyTime now, std::vector<Change>& changes);

private:
  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, Silence> beacons_;
};

}  // namespace sonopose::process
