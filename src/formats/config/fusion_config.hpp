#pragma once
/// \file
/// Loads the fusion's settings from a TOML file and the command line, with overrides per beacon.

#include "config/beacon_settings.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::config {

/// An unusable configuration. The message names file and line (or the argument), key, value and what is
/// allowed.
class ConfigError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Settings for all beacons, and overrides for single ones.
class FusionConfig {
public:
  /// All settings at their defaults.
  FusionConfig() = default;

  /// Reads a TOML file with a table per settings group (`[documented.drift]`), and per beacon
  /// `[beacon.7.documented.drift]`. Throws ConfigError for invalid TOML, an unknown key, and a value of the
  /// wrong type or out of range.
  static FusionConfig load(const std::filesystem::path& file);

  /// Applies `group.key=value` or `beacon.7.group.key=value`, as typed after --set. Throws ConfigError.
  void assign(std::string_view assignment);

  /// The settings of one beacon's estimator.
  [[nodiscard]] settings::Settings for_beacon(BeaconAddress address) const;

  /// The same, including which keys are the beacon's own. For all_beacons: the common settings.
  [[nodiscard]] BeaconSettings beacon(BeaconAddress address) const;

  /// The network interfaces of the file: `interface = "lo, wlan0"` in its table `[bus]`. No setting: only the
  /// fusion reads it, at its start.
  [[nodiscard]] const std::vector<std::string>& interfaces() const { return interfaces_; }

  /// The beacons with settings of their own.
  [[nodiscard]] std::vector<BeaconAddress> beacons() const;

  /// Throws ConfigError if an estimator cannot work with the settings of a beacon.
  void check() const;

  /// Returns warnings about valid but probably unintended settings: items 2–4 with a preset that replaces
  /// them, and contradictions.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// The complete configuration as a commented TOML file, which loads back to the same values.
  [[nodiscard]] std::string to_toml() const;

  /// The settings that were given, as TOML.
  [[nodiscard]] std::string given_toml() const;

private:
  void set(std::string_view key, const settings::SettingValue& value);

  settings::Settings settings_;
  std::vector<std::string> interfaces_;
  Assignments given_;  ///< settings that the user gave for all beacons
  std::map<BeaconAddress, Assignments> overrides_;
};

/// The table of all settings as a page of the docs.
std::string settings_page();

/// The same as lines for a program's help: key, default, what is allowed, and the document's item if there is
/// one. `group` selects a group with its subgroups ("heading", "documented.attitude") or a single key;
/// without it, all. Empty if the name is unknown.
std::string settings_help(const std::string& group = {});

/// The names of all groups, such as "heading" and "documented.attitude.mahony".
std::vector<std::string> settings_groups();

}  // namespace sonopose::config
