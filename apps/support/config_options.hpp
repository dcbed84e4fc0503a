#pragma once
// What every program with fusion settings has in common: --config, --set and --help-settings.

#include "config/fusion_config.hpp"
#include <sonopose/samples/samples.hpp>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

/// Where the settings come from.
struct ConfigOptions {
  std::optional<std::filesystem::path> file;
  std::vector<std::string> assignments;
};

/// The group of these options.
inline constexpr const char* settings_group = "Settings";

/// Adds --config, --set and --help-settings.
void add_config_options(CLI::App& app, ConfigOptions& options);

/// Sets a key for all beacons and for this one, above --set.
void assign_everywhere(ConfigOptions& options, BeaconAddress beacon, const std::string& key,
                       const std::string& value);

/// Adds --beacon: whose own settings apply where events name no beacon.
void add_beacon_option(CLI::App& app, BeaconAddress& beacon);
/// The same where a log may name its beacon, which is the default.
void add_beacon_option(CLI::App& app, std::optional<BeaconAddress>& beacon);

/// Reads them, --set above --config; logs its warnings. Throws config::ConfigError.
config::FusionConfig configuration(const CLI::App& app, const ConfigOptions& options);

}  // namespace sonopose::apps
