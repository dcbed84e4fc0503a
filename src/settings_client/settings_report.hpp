#pragma once
/// \file
/// What sonopose-settings prints.

#include <sonopose/samples/live_settings.hpp>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::settings_client {

/// Reads KEY=VALUE. Throws std::invalid_argument where it is not of that form; whether the setting can be is
/// for the fusion to say.
SettingAssignment read_assignment(std::string_view text);

/// Checks that each name is a key or a group of the settings table. Throws settings::SettingError, naming the
/// nearest key, where one is not.
void check_names(const std::vector<std::string>& names);

/// Keeps the values under `names`, each a key or a group ("drift"); no names: all. Throws
/// std::invalid_argument for a name under which there is nothing.
EffectiveSettings chosen(EffectiveSettings settings, const std::vector<std::string>& names);

/// TOML, which sonopose-fusion --config loads, of the values under `names` (as `chosen` takes them): a table
/// per beacon, [beacon.7]; what is under all_beacons, which must be first, is at the top level. Items 2, 3
/// and 4 stand behind a # where a preset (item 1) sets them.
std::string toml_of(const std::vector<EffectiveSettings>& settings,
                    const std::vector<std::string>& names = {});

/// A JSON array with an object per beacon ("all" for all_beacons), on one line:
/// {"beacon": 7, "from_event": 12, "time_ns": …, "settings": {"drift.jump_alpha": 0.5, …}}.
std::string json_of(const std::vector<EffectiveSettings>& settings);

/// Tells what changes, from beacon to beacon.
class SettingsObserver {
public:
  /// `json`: an object per change, {"beacon": 7, "from_event": …, "time_ns": …, "changed": {…}}, instead of a
  /// line per key, "beacon.7.drift.jump_alpha = 0.5  # was 0.25, from event 1200". What is under all_beacons
  /// has no "beacon.7." in front, and in an object the beacon "all".
  explicit SettingsObserver(bool json) : json_(json) {}

  [[nodiscard]] bool knows(BeaconAddress address) const { return latest_.contains(address); }

  /// Lines, each ended by a newline, for what is not as it was; none for a beacon that was not known.
  std::string on(const EffectiveSettings& settings);

private:
  bool json_;
  std::map<BeaconAddress, EffectiveSettings> latest_;
};

/// An accepted request's answer in words: from when on it holds.
std::string when_of(const SettingsReply& reply);

}  // namespace sonopose::settings_client
