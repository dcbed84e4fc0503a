#include "fusion/input_monitor.hpp"

namespace sonopose::fusion {

void InputMonitor::on_deadline_missed(BeaconAddress address, std::uint64_t InputCounters::*counter,
                                      std::uint64_t more) {
  const auto found = beacons_.find(address);
  if (found != beacons_.end()) found->second.counters.*counter += more;
}

void InputMonitor::on_bridge_lost(std::uint64_t bridge) {
  for (auto& entry : beacons_) {
    if (entry.second.bridge == bridge) ++entry.second.counters.bridge_losses;
  }
}

InputCounters InputMonitor::counters(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found == beacons_.end() ? InputCounters{} : found->second.counters;
}

}  // namespace sonopose::fusion
