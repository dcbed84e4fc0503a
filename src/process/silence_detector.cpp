#include "process/silence_detector.hpp"

namespace sonopose::process {

void SilenceDetector::find_changes(SteadyTime now, std::vector<Change>& changes) {
  for (auto& [address, beacon] : beacons_) {
    const bool silent = now - beacon.latest > deadline_ns_;
    if (silent == beacon.silent) continue;
    beacon.silent = silent;
    if (silent) beacon.silent_since = beacon.latest;
    const SteadyTime until = silent ? now : beacon.latest;
    changes.push_back({address, silent, seconds_between(beacon.silent_since, until)});
  }
}

bool SilenceDetector::is_silent(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found != beacons_.end() && found->second.silent;
}

}  // namespace sonopose::process
