#pragma once
/// \file
/// What the middleware has told a fusion process of the streams that feed each beacon's engine: missed
/// deadlines, and bridges that died.

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

/// All beacons. Not for several threads at once: no locks. Allocates at a beacon's first sample alone.
class InputMonitor {
public:
  /// An IMU sample that came from the writer `bridge` (its publication handle).
  void on_imu(BeaconAddress address, std::uint64_t bridge) { beacons_[address].bridge = bridge; }

  /// Some periods of one of a beacon's streams went by without a sample. Ignored for a beacon not heard of.
  void on_deadline_missed(BeaconAddress address, std::uint64_t InputCounters::*counter, std::uint64_t more);

  /// A bridge is no longer alive: counted for every beacon that it served last.
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
