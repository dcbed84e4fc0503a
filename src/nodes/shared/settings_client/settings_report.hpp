#pragma once
/// \file
/// The output of sonopose-settings: TOML, JSON and changes.

#include <sonopose/samples/live_settings.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::settings_client {

/// Parses KEY=VALUE. Throws std::invalid_argument without '=' or key. The fusion validates key and value.
SettingAssignment parse_assignment(std::string_view text);

/// Checks that each name is a key or a group of the settings table. Throws settings::SettingError with the
/// nearest key.
void check_names(const std::vector<std::string>& names);

/// Keeps the values of `names`, each a key or a group ("documented.drift"); all if `names` is empty. Throws
/// std::invalid_argument for a name without values.
EffectiveSettings selected(EffectiveSettings settings, const std::vector<std::string>& names);

/// Formats the values of `names` (see `selected`) as TOML: those of all_beacons, which must be first, at the
/// top level, then one table per beacon ([beacon.7]). Values that a preset sets are commented out.
std::string toml_of(const std::vector<EffectiveSettings>& settings,
                    const std::vector<std::string>& names = {});

/// Writes changed settings (SettingsClient::changed) as a file for sonopose-fusion --config, and replaces an
/// existing one. Returns what was saved, for the user. Throws files::IoError.
std::string save(const std::vector<EffectiveSettings>& changed, const std::filesystem::path& file);

/// Writes the drop-in BASE.d/90-saved.toml with what differs from the file `base` and its other drop-ins, so
/// that a fusion with --config BASE starts with these settings. Returns what was saved, for the user. Throws
/// files::IoError, config::ConfigError.
std::string save_drop_in(const std::vector<EffectiveSettings>& changed, const std::filesystem::path& base);

/// A JSON array with one object per beacon ("all" for all_beacons), on one line:
/// {"beacon": 7, "from_event": 12, "time_ns": …, "settings": {"documented.drift.jump_alpha": 0.5, …}}.
std::string json_of(const std::vector<EffectiveSettings>& settings);

/// Formats changes of the effective settings, per beacon.
class SettingsObserver {
public:
  /// Default: one line per key, "beacon.7.documented.drift.jump_alpha = 0.5  # was 0.25, from event 1200",
  /// without "beacon.7." for all_beacons. `json`: one object per change, {"beacon": 7, "from_event": …,
  /// "time_ns": …, "changed": {…}}, with "all" for all_beacons.
  explicit SettingsObserver(bool json) : json_(json) {}

  [[nodiscard]] bool has_settings_of(BeaconAddress address) const { return latest_.contains(address); }

  /// Formats the changes since the previous settings of the same beacon, each line with a newline. Empty for
  /// the first settings.
  std::string on(const EffectiveSettings& settings);

private:
  bool json_;
  std::map<BeaconAddress, EffectiveSettings> latest_;
};

/// Text that says when an accepted request takes effect.
std::string effective_time_text(const SettingsReply& reply);

/// True if every known beacon keeps values of its own, so that the request changes only later ones.
bool changes_no_known_beacon(const SettingsReply& reply);

}  // namespace sonopose::settings_client
