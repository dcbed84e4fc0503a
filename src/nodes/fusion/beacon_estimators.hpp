#pragma once
/// \file
/// One estimator per beacon address, created at the beacon's first event, and the settings for each address.

#include "config/fusion_config.hpp"
#include "fusion/beacon_estimator.hpp"
#include "fusion/settings_timeline.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace sonopose::fusion {

/// Returns the errors of the sensors that are known before a beacon's first event.
using KnownSensorsOf =
    std::function<std::optional<estimation::aiding::KnownSensors>(BeaconAddress, const settings::Settings&)>;

/// All estimators. Not thread-safe. They are shared pointers, so that one in use can be removed.
class BeaconEstimators {
public:
  /// `lossless`: see BeaconEstimator.
  BeaconEstimators(const config::FusionConfig& config, bool lossless, KnownSensorsOf known_sensors_of = {});

  /// The estimator of a beacon, created if there is none.
  const std::shared_ptr<BeaconEstimator>& find_or_make(BeaconAddress address);

  /// The estimator of a beacon; null if no event has arrived from it.
  [[nodiscard]] BeaconEstimator* find(BeaconAddress address) const;

  /// Calls `visit(BeaconAddress, BeaconEstimator&)` for each beacon from which events have arrived.
  void for_each(const auto& visit) {
    for (const auto& [address, estimator] : estimators_) visit(address, *estimator);
  }

  /// True if any estimator has an unreported change (BeaconEstimator::has_unreported_change).
  [[nodiscard]] bool have_unreported_changes(SteadyTime now, TimeNs deadline_ns) const;

  /// Beacons from which events have arrived.
  [[nodiscard]] std::vector<BeaconAddress> addresses() const;

  /// Removes and returns the estimators of beacons that are gone at `now` (BeaconEstimator::is_gone). Keeps
  /// settings of their own.
  std::vector<std::pair<BeaconAddress, std::shared_ptr<BeaconEstimator>>> remove_gone(SteadyTime now);

  /// Resets the estimator of one beacon, or of all for all_beacons (BeaconEstimator::reset).
  void reset(BeaconAddress address, std::uint64_t request_id);

  /// The latest settings of each beacon whose settings changed with events since the last call.
  std::vector<SettingsChange> take_settings_changes();

  /// The settings of a beacon without settings of its own, after all accepted changes for all beacons. The
  /// address is all_beacons; from_sequence is that of the last of these changes.
  [[nodiscard]] SettingsChange settings_for_all() const;

  /// Settings by event number, and the number of the latest processed event; empty if there was none.
  struct Schedule {
    SettingsTimeline timeline;
    std::optional<std::uint64_t> last_sequence;
  };

  /// Copies the schedule of a beacon, or for all_beacons that of beacons without settings of their own.
  [[nodiscard]] Schedule schedule(BeaconAddress address) const;

  /// Beacons with a schedule of their own, because they were configured, were changed or have sent events.
  /// Ordered by address.
  [[nodiscard]] std::vector<BeaconAddress> scheduled() const;

  /// Replaces the settings of a beacon, or for all_beacons those of beacons that appear later. Leaves the
  /// former ones in `timeline`.
  void exchange_timeline(BeaconAddress address, SettingsTimeline& timeline);

private:
  bool lossless_;
  KnownSensorsOf known_sensors_of_;
  SettingsTimeline default_timeline_;                          ///< beacons that are not scheduled
  std::map<BeaconAddress, SettingsTimeline> later_timelines_;  ///< scheduled beacons without an estimator
  std::unordered_map<BeaconAddress, std::shared_ptr<BeaconEstimator>> estimators_;
};

}  // namespace sonopose::fusion
