#pragma once
/// \file
/// Counts missed deadlines and lost bridges of each beacon's input streams.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <unordered_map>

namespace sonopose::fusion {

/// Counters of one beacon, since its first IMU sample.
struct InputCounters {
  std::uint64_t imu_deadlines_missed = 0;
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  std::uint64_t bridge_losses = 0;
};

/// All beacons. Not thread-safe. Allocates only at a beacon's first sample.
class InputMonitor {
public:
  /// An IMU sample from the writer with the publication handle `bridge`.
  void on_imu(BeaconAddress address, std::uint64_t bridge) { beacons_[address].bridge = bridge; }

  /// Adds deadline periods without a sample of one of a beacon's streams. Ignored for an unknown beacon.
  void on_deadline_missed(BeaconAddress address, std::uint64_t InputCounters::*counter, std::uint64_t more);

  /// A bridge is no longer alive: counts it for every beacon whose latest sample it sent.
  void on_bridge_lost(std::uint64_t bridge);

  [[nodiscard]] InputCounters counters(BeaconAddress address) const;

private:
  struct Beacon {
    std::uint64_t bridge = 0;
    InputCounters counters;
  };
  std::unordered_map<BeaconAddress, Beacon> beacons_;
};

}  // namespace sonopose::fusion
