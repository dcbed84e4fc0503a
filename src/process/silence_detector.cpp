#include "process/silence_detector.hpp"

namespace sonopose::process {

void SilenceDetector::find_changes(TimeNs now_ns, std::vector<Change>& changes) {
  for (auto& [address, beacon] : beacons_) {
    const bool silent = now_ns - beacon.latest_ns > deadline_ns_;
    if (silent == beacon.silent) continue;
    beacon.silent = silent;
    if (silent) beacon.silent_since_ns = beacon.latest_ns;
    const TimeNs until_ns = silent ? now_ns : beacon.latest_ns;
    changes.push_back({address, silent, seconds_between(beacon.silent_since_ns, until_ns)});
  }
}

bool SilenceDetector::is_silent(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found != beacons_.end() && found->second.silent;
}

}  // namespace sonopose::process
