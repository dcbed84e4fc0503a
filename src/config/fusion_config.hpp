#pragma once
/// \file
/// The fusion's settings from a TOML file and from the command line, with overrides per beacon.

#include "config/beacon_settings.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::config {

/// A configuration that cannot be used; the message names file and line (or the argument), key, value and
/// what is allowed.
class ConfigError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Settings for every beacon, and what differs for single ones.
class FusionConfig {
public:
  /// Everything at its default.
  FusionConfig() = default;

  /// Reads a TOML file: a table per settings group (`[drift]`), and per beacon `[beacon.7.drift]`.
  /// Throws ConfigError for what is not TOML, an unknown key, a value of the wrong kind or out of range.
  static FusionConfig load(const std::filesystem::path& file);

  /// Applies `group.key=value` or `beacon.7.group.key=value`, as typed after --set. Throws ConfigError.
  void assign(std::string_view assignment);

  /// The settings of one beacon's estimator.
  [[nodiscard]] settings::Settings for_beacon(BeaconAddress address) const;

  /// The same, with the keys that are the beacon's own. For all_beacons: the settings of beacons without any.
  [[nodiscard]] BeaconSettings beacon(BeaconAddress address) const;

  /// The beacons that have settings of their own.
  [[nodiscard]] std::vector<BeaconAddress> beacons() const;

  /// Throws ConfigError if an estimator cannot work with the settings of a beacon.
  void check() const;

  /// Warnings about valid but probably unintended settings: items 2–4 with a preset that replaces them,
  /// and settings that contradict each other.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// The whole as a commented TOML file, which loads back to the same values.
  [[nodiscard]] std::string to_toml() const;

  /// As TOML: only what was set.
  [[nodiscard]] std::string given_toml() const;

private:
  void set(std::string_view key, const settings::SettingValue& value);

  settings::Settings settings_;
  Assignments given_;  ///< what the user set for all beacons
  std::map<BeaconAddress, Assignments> overrides_;
};

/// The table of all settings as a page of the docs.
std::string settings_page();

/// The same as lines for a program's help: key, default, what is allowed; the document's item where it has
/// one. `group` selects "heading", "attitude" with the groups in it, or a single key; without it, all. Empty
/// if nothing has this name.
std::string settings_help(const std::string& group = {});

/// Every group: "heading", "attitude.mahony".
std::vector<std::string> settings_groups();

}  // namespace sonopose::config
