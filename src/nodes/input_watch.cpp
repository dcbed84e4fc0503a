#include <sonopose/nodes/input_watch.hpp>

namespace sonopose::nodes {

void InputWatch::on_imu(BeaconAddress address, std::uint64_t bridge, TimeNs now_ns) {
  Beacon& beacon = beacons_[address];
  beacon.latest_ns = now_ns;
  beacon.bridge = bridge;
}

void InputWatch::on_deadline_missed(BeaconAddress address, std::uint64_t InputCounters::*counter,
                                    std::uint64_t more) {
  const auto found = beacons_.find(address);
  if (found != beacons_.end()) found->second.counters.*counter += more;
}

void InputWatch::on_bridge_lost(std::uint64_t bridge) {
  for (auto& entry : beacons_) {
    if (entry.second.bridge == bridge) ++entry.second.counters.bridge_losses;
  }
}

void InputWatch::find_changes(TimeNs now_ns, std::vector<BeaconAddress>& changed) {
  for (auto& [address, beacon] : beacons_) {
    const bool silent = now_ns - beacon.latest_ns > deadline_ns_;
    if (silent != beacon.silent) changed.push_back(address);
    beacon.silent = silent;
  }
}

bool InputWatch::is_silent(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found != beacons_.end() && found->second.silent;
}

InputCounters InputWatch::counters(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found == beacons_.end() ? InputCounters{} : found->second.counters;
}

}  // namespace sonopose::nodes
