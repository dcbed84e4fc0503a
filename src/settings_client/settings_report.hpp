#pragma once
/// \file
/// The output of sonopose-settings: TOML, JSON and changes.

#include <sonopose/samples/live_settings.hpp>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::settings_client {

/// Parses KEY=VALUE. Throws std::invalid_argument if there is no '=' or no key. The fusion validates key and
/// value.
SettingAssignment parse_assignment(std::string_view text);

/// Checks that each name is a key or a group of the settings table. Throws settings::SettingError with the
/// nearest key.
void check_names(const std::vector<std::string>& names);

/// Keeps the values of `names`, each a key or a group ("drift"); all if `names` is empty. Throws
/// std::invalid_argument for a name without values.
EffectiveSettings selected(EffectiveSettings settings, const std::vector<std::string>& names);

/// TOML for sonopose-fusion --config with the values of `names` (see `selected`): a table per beacon,
/// [beacon.7]. The settings of all_beacons must be first and are written at the top level. Items 2, 3 and 4
/// are commented out if a preset (item 1) sets them.
std::string toml_of(const std::vector<EffectiveSettings>& settings,
                    const std::vector<std::string>& names = {});

/// A JSON array with an object per beacon ("all" for all_beacons), on one line:
/// {"beacon": 7, "from_event": 12, "time_ns": …, "settings": {"drift.jump_alpha": 0.5, …}}.
std::string json_of(const std::vector<EffectiveSettings>& settings);

/// Formats changes of the effective settings, per beacon.
class SettingsObserver {
public:
  /// Default: a line per key, "beacon.7.drift.jump_alpha = 0.5  # was 0.25, from event 1200", without
  /// "beacon.7." for all_beacons. `json`: an object per change, {"beacon": 7, "from_event": …, "time_ns": …,
  /// "changed": {…}}, with "all" for all_beacons.
  explicit SettingsObserver(bool json) : json_(json) {}

  [[nodiscard]] bool has_settings_of(BeaconAddress address) const { return latest_.contains(address); }

  /// The changes since the previous settings of the same beacon, each line with a newline. Empty for the
  /// first settings.
  std::string on(const EffectiveSettings& settings);

private:
  bool json_;
  std::map<BeaconAddress, EffectiveSettings> latest_;
};

/// When an accepted request takes effect, as text.
std::string effective_time_text(const SettingsReply& reply);

}  // namespace sonopose::settings_client
