#pragma once
// The options --config, --set and --help-settings, common to all programs with fusion settings.

#include "command_line.hpp"
#include "config/fusion_config.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

/// A setting that another option of a program chooses.
struct ChosenSetting {
  std::string key;
  std::string value;
  std::optional<BeaconAddress> beacon;  ///< also above the own settings of this beacon
};

/// The sources of the settings.
struct ConfigOptions {
  std::optional<std::filesystem::path> file;
  std::vector<std::string> assignments;
  std::vector<ChosenSetting> chosen;  ///< with precedence over --set
};

/// The group of these options.
inline constexpr const char* settings_group = "Settings";

/// Adds --config, --set and --help-settings.
void add_config_options(CommandLine& app, ConfigOptions& options);

/// Adds --beacon, which selects the settings for events that name no beacon.
void add_beacon_option(CommandLine& app, BeaconAddress& beacon);
/// The same for a log that may name its beacon, which is the default.
void add_beacon_option(CommandLine& app, std::optional<BeaconAddress>& beacon);

/// Adds --beacon, which also takes "all" for all_beacons, the default.
void add_beacon_or_all_option(CommandLine& app, BeaconAddress& beacon);

/// Reads the settings, with --set above --config, and logs their warnings. Those of the other engine are no
/// mistake if an option chooses the engine. Throws config::ConfigError.
config::FusionConfig configuration(const ConfigOptions& options);

/// Returns the settings of one beacon, or those for all. Warns if other beacons have settings of their own,
/// but this one has none: they are probably meant for it.
settings::Settings settings_of(const config::FusionConfig& config, BeaconAddress beacon);

}  // namespace sonopose::apps
