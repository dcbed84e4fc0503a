#pragma once
/// \file
/// The settings of one beacon: those for all beacons, overridden by its own.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::config {

/// Values by key, each known to be allowed.
using Assignments = std::map<std::string, settings::SettingValue, std::less<>>;

/// Parses typed values. Throws settings::SettingError, which names every key that cannot be set
/// with its value and what is allowed, and every key that is named twice.
Assignments parsed(const std::vector<SettingAssignment>& texts);

/// Every setting as text that reads back to the same bits, in the order of the table.
std::vector<SettingAssignment> texts_of(const settings::Settings& settings);

/// Whether this is one of items 2, 3 and 4, which a preset (item 1) replaces.
bool is_preset_key(std::string_view key);

/// Warnings, in plain words, for those of the `given` keys that the preset in `settings` replaces; `where`
/// precedes each key.
std::vector<std::string> preset_warnings(const settings::Settings& settings, const Assignments& given,
                                         std::string_view where = "");

/// Warnings, in plain words, for settings that contradict each other, where one of them is a `given` key.
std::vector<std::string> contradictions(const settings::Settings& settings, const Assignments& given,
                                        std::string_view where = "");

/// Warnings, in plain words, for those of the `given` keys that differ from their default and belong to an
/// attitude filter which is not chosen, or to a magnetometer which is not used.
std::vector<std::string> idle_filter_warnings(const settings::Settings& settings, const Assignments& given,
                                              std::string_view where = "");

/// Why an estimator cannot work with these settings, in plain words; empty if it can.
std::string fault_of(const settings::Settings& settings);

/// All of the warnings: what is allowed but hardly intended.
std::vector<std::string> warnings_for(const settings::Settings& settings, const Assignments& given,
                                      std::string_view where = "");

/// The warnings for keys that are `given` for all beacons. `common` are the settings of a beacon without its
/// own, `own` those of the beacons that have some. A key that only some engines read is no reason for a
/// warning if one of these beacons has such an engine; those that have another one are named.
std::vector<std::string> warnings_for_all(const settings::Settings& common, const Assignments& given,
                                          const std::map<BeaconAddress, settings::Settings>& own);

/// The settings of one estimator, and which of them are the beacon's own.
class BeaconSettings {
public:
  BeaconSettings() = default;
  explicit BeaconSettings(const settings::Settings& for_all) : settings_(for_all) {}

  /// A change for all beacons: leaves alone what is the beacon's own.
  void assign_for_all(const Assignments& assignments);

  /// A change for this beacon: from now on these keys are its own.
  void assign_own(const Assignments& assignments);

  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  [[nodiscard]] bool has_own() const { return !own_.empty(); }

private:
  settings::Settings settings_;
  std::set<std::string, std::less<>> own_;
};

}  // namespace sonopose::config
