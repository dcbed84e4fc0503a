#pragma once
/// \file
/// One estimator per beacon address, made when the beacon's first event arrives, and the settings for each
/// address.

#include "config/fusion_config.hpp"
#include "fusion/beacon_estimator.hpp"
#include "fusion/settings_timeline.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace sonopose::fusion {

/// Not thread-safe. The estimators are shared, so that one can be in use while it is removed.
class BeaconEstimators {
public:
  /// `lossless`: see BeaconEstimator.
  BeaconEstimators(const config::FusionConfig& config, bool lossless);

  /// The estimator of a beacon, made if there is none.
  const std::shared_ptr<BeaconEstimator>& find_or_make(BeaconAddress address);

  /// The estimator of a beacon; null if no event has arrived from it.
  [[nodiscard]] BeaconEstimator* find(BeaconAddress address) const;

  /// Calls `visit(BeaconAddress, BeaconEstimator&)` for each beacon from which events have arrived.
  void for_each(const auto& visit) {
    for (const auto& [address, estimator] : estimators_) visit(address, *estimator);
  }

  /// Whether any estimator has one; see BeaconEstimator::has_unreported_change.
  [[nodiscard]] bool have_unreported_changes(SteadyTime now, TimeNs deadline_ns) const;

  /// The beacons from which events have arrived.
  [[nodiscard]] std::vector<BeaconAddress> addresses() const;

  /// Removes and returns the estimators of beacons that are gone at `now` (see BeaconEstimator::is_gone).
  /// Their own settings are kept.
  std::vector<std::pair<BeaconAddress, std::shared_ptr<BeaconEstimator>>> remove_gone(SteadyTime now);

  /// Resets the estimator of one beacon, or of all for all_beacons; see BeaconEstimator::reset.
  void reset(BeaconAddress address, std::uint64_t request_id);

  /// The settings that changed with events since the last call: the latest of each beacon.
  std::vector<SettingsChange> take_settings_changes();

  /// The settings of a beacon without settings of its own, after all accepted changes for all beacons. Its
  /// address is all_beacons, its from_sequence that of the last of these changes.
  [[nodiscard]] SettingsChange settings_for_all() const;

  /// Settings, by event number, and the last event that was processed; empty if there was none.
  struct Schedule {
    SettingsTimeline timeline;
    std::optional<std::uint64_t> last_sequence;
  };

  /// A copy of the schedule of a beacon, or for all_beacons of one without settings of its own.
  [[nodiscard]] Schedule schedule(BeaconAddress address) const;

  /// The beacons that have a schedule of their own, because they were configured or changed or have sent
  /// events; in the order of the addresses.
  [[nodiscard]] std::vector<BeaconAddress> scheduled() const;

  /// Replaces the settings of a beacon, or for all_beacons of those that appear later. The former ones are
  /// left in `timeline`.
  void exchange_timeline(BeaconAddress address, SettingsTimeline& timeline);

private:
  bool lossless_;
  SettingsTimeline default_timeline_;                          ///< of beacons that are not scheduled
  std::map<BeaconAddress, SettingsTimeline> later_timelines_;  ///< of scheduled beacons without an estimator
  std::unordered_map<BeaconAddress, std::shared_ptr<BeaconEstimator>> estimators_;
};

}  // namespace sonopose::fusion
