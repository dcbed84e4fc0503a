#pragma once
/// \file
/// What a fusion process knows of the streams that feed each beacon's engine: whether its IMU is silent, and
/// what the middleware has told of missed deadlines and of bridges that died.

#include <sonopose/core/samples.hpp>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace sonopose::nodes {

/// Counters of one beacon, since its first IMU sample.
struct InputCounters {
  std::uint64_t imu_deadlines_missed = 0;
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  std::uint64_t bridge_losses = 0;
};

/// All beacons. Times are of the steady clock. Not for several threads at once: no locks. Allocates at a
/// beacon's first sample alone.
class InputWatch {
public:
  /// `deadline_ns`: an IMU without a sample for so long is silent.
  explicit InputWatch(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  /// An IMU sample that came at `now_ns` from the writer `bridge` (its publication handle).
  void on_imu(BeaconAddress address, std::uint64_t bridge, TimeNs now_ns);

  /// Some periods of one of a beacon's streams went by without a sample. Ignored for a beacon not heard of.
  void on_deadline_missed(BeaconAddress address, std::uint64_t InputCounters::*counter, std::uint64_t more);

  /// A bridge is no longer alive: counted for every beacon that it served last.
  void on_bridge_lost(std::uint64_t bridge);

  /// Adds to `changed` the beacons whose IMU fell silent or came back since the last call.
  void find_changes(TimeNs now_ns, std::vector<BeaconAddress>& changed);

  [[nodiscard]] bool is_silent(BeaconAddress address) const;
  [[nodiscard]] InputCounters counters(BeaconAddress address) const;

private:
  struct Beacon {
    TimeNs latest_ns = 0;
    std::uint64_t bridge = 0;
    bool silent = false;
    InputCounters counters;
  };

  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, Beacon> beacons_;
};

}  // namespace sonopose::nodes
