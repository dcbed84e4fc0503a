#pragma once
/// \file
/// The settings that a configuration file needs.

#include "fusion/beacon_estimators.hpp"
#include "presence/address_set.hpp"
#include "threads/guarded.hpp"
#include <sonopose/samples/live_settings.hpp>

#include <map>
#include <vector>

namespace sonopose::fusion {

/// Follows what differs from the defaults and what is a beacon's own after all accepted changes, also for
/// beacons that were not received. Poses do not wait, as in SettingsRequests.
class ChangedSettings {
public:
  ChangedSettings(threads::Guarded<BeaconEstimators>& estimators, const presence::AddressSet& addresses)
      : estimators_(estimators), addresses_(addresses) {}

  /// Returns what has to be published after a change for `address`, or for all_beacons at the start: beacons
  /// with new values first, all_beacons last. A reader that has received all_beacons has thus received all.
  /// Empty if nothing differs from the last call.
  std::vector<EffectiveSettings> update(BeaconAddress address);

private:
  threads::Guarded<BeaconEstimators>& estimators_;
  const presence::AddressSet& addresses_;
  std::map<BeaconAddress, std::vector<SettingAssignment>> known_;
};

}  // namespace sonopose::fusion
