#pragma once
/// \file
/// The settings of one beacon: the common ones, overridden by its own.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::config {

/// Valid values by key.
using Assignments = std::map<std::string, settings::SettingValue, std::less<>>;

/// Parses typed values. Throws settings::SettingError, which names every invalid key with its value and what
/// is allowed, and every repeated key.
Assignments parsed(const std::vector<SettingAssignment>& texts);

/// Writes every setting as text that reads back to the same bits, in the order of the table.
std::vector<SettingAssignment> texts_of(const settings::Settings& settings);

/// Writes the values that differ from the defaults as text, in the order of the table.
std::vector<SettingAssignment> changed_texts_of(const settings::Settings& settings);

/// Returns true for a key of items 2, 3 and 4, which a preset (item 1) replaces.
bool is_preset_key(std::string_view key);

/// Returns warnings about `given` keys that the preset in `settings` replaces. `where` precedes each key.
std::vector<std::string> preset_warnings(const settings::Settings& settings, const Assignments& given,
                                         std::string_view where = "");

/// Returns warnings about settings that contradict each other, if one of them is a `given` key.
std::vector<std::string> contradictions(const settings::Settings& settings, const Assignments& given,
                                        std::string_view where = "");

/// Returns warnings about `given` keys that differ from their default but are not read: those of an attitude
/// filter that is not chosen, or of an unused magnetometer.
std::vector<std::string> idle_filter_warnings(const settings::Settings& settings, const Assignments& given,
                                              std::string_view where = "");

/// Returns why an estimator cannot work with these settings, in plain words; empty if it can.
std::string fault_of(const settings::Settings& settings);

/// Settings that only the other engine reads: a mistake, unless a program chooses the engine itself.
enum class OtherEngine : std::uint8_t { warned_of, ignored };

/// All warnings about allowed but hardly intended settings.
std::vector<std::string> warnings_for(const settings::Settings& settings, const Assignments& given,
                                      std::string_view where = "",
                                      OtherEngine other_engine = OtherEngine::warned_of);

/// Warnings for keys that are `given` for all beacons. `common` applies to beacons without settings of their
/// own, `own` has the other beacons. Warnings of beacons with another engine name these beacons.
std::vector<std::string> warnings_for_all(const settings::Settings& common, const Assignments& given,
                                          const std::map<BeaconAddress, settings::Settings>& own,
                                          OtherEngine other_engine = OtherEngine::warned_of);

/// The settings of one estimator. Remembers which of them are the beacon's own.
class BeaconSettings {
public:
  BeaconSettings() = default;
  explicit BeaconSettings(const settings::Settings& for_all) : settings_(for_all) {}

  /// Changes the common settings; the beacon's own stay as they are.
  void assign_for_all(const Assignments& assignments);

  /// Changes settings of this beacon, which then count as its own.
  void assign_own(const Assignments& assignments);

  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  [[nodiscard]] bool has_own() const { return !own_.empty(); }

  /// Its own settings as text, also those that equal the common ones now.
  [[nodiscard]] std::vector<SettingAssignment> own_texts() const;

private:
  settings::Settings settings_;
  std::set<std::string, std::less<>> own_;
};

}  // namespace sonopose::config
