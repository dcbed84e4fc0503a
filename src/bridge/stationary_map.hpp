#pragma once
/// \file
/// The stationary beacons that a bridge has published.

#include <sonopose/samples/samples.hpp>

#include <map>

namespace sonopose::bridge {

/// The hardware sends its map again and again; only changes are published.
class StationaryMap {
public:
  /// Whether the beacon is new, has moved, or its position is known or unknown now: then it is kept.
  bool update(const StationaryBeacon& beacon) {
    const auto [known, is_new] = beacons_.try_emplace(beacon.address, beacon);
    if (!is_new && !has_changed(known->second, beacon)) return false;
    known->second = beacon;
    return true;
  }

  /// By address. A line has at most 256.
  [[nodiscard]] const std::map<BeaconAddress, StationaryBeacon>& beacons() const { return beacons_; }

private:
  static bool has_changed(const StationaryBeacon& known, const StationaryBeacon& beacon) {
    if (!known.position_world_m || !beacon.position_world_m) {
      return known.position_world_m.has_value() != beacon.position_world_m.has_value();
    }
    constexpr double least_m = 0.5e-3;  // the hardware sends whole millimetres or centimetres
    return (*known.position_world_m - *beacon.position_world_m).norm() > least_m;
  }

  std::map<BeaconAddress, StationaryBeacon> beacons_;
};

}  // namespace sonopose::bridge
