#pragma once
/// \file
/// Stationary beacons that a bridge has published.

#include <sonopose/samples/samples.hpp>

#include <map>

namespace sonopose::publication {

/// Filters the map, which the hardware repeats: only changes are published.
class StationaryMap {
public:
  /// Keeps the beacon and returns true if it is new, has moved, or gained or lost its position.
  bool update(const StationaryBeacon& beacon) {
    const auto [known, is_new] = beacons_.try_emplace(beacon.address, beacon);
    if (!is_new && !has_changed(known->second, beacon)) return false;
    known->second = beacon;
    return true;
  }

  /// Beacons by address, at most 256 on a line.
  [[nodiscard]] const std::map<BeaconAddress, StationaryBeacon>& beacons() const { return beacons_; }

private:
  static bool has_changed(const StationaryBeacon& known, const StationaryBeacon& beacon) {
    if (!known.position_world_m || !beacon.position_world_m) {
      return known.position_world_m.has_value() != beacon.position_world_m.has_value();
    }
    constexpr double min_m = 0.5e-3;  // the hardware sends whole millimetres or centimetres
    return (*known.position_world_m - *beacon.position_world_m).norm() > min_m;
  }

  std::map<BeaconAddress, StationaryBeacon> beacons_;
};

}  // namespace sonopose::publication
