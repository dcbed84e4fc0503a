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

/// The table of a settings file that has options of sonopose-fusion instead of settings, with a dot.
inline constexpr std::string_view program_prefix = "program.";

/// Settings for all beacons, and overrides for single ones.
class FusionConfig {
public:
  /// All settings at their defaults.
  FusionConfig() = default;

  /// Reads a TOML file with a table per settings group (`[documented.drift]`), and per beacon
  /// `[beacon.7.documented.drift]`, and then its drop-ins FILE.d/*.toml except `without`. Skips the table
  /// `[program]`, which has options of sonopose-fusion. A key of an earlier version is a warning. Throws
  /// ConfigError for invalid TOML, an unknown key, and a value of the wrong type or out of range.
  static FusionConfig load(const std::filesystem::path& file, const std::filesystem::path& without = {});

  /// Applies `group.key=value` or `beacon.7.group.key=value`, as typed after --set. Throws ConfigError.
  void assign(std::string_view assignment);

  /// The settings of one beacon's estimator.
  [[nodiscard]] settings::Settings for_beacon(BeaconAddress address) const;

  /// The settings of one beacon, with the keys that are its own. For all_beacons: the common settings.
  [[nodiscard]] BeaconSettings beacon(BeaconAddress address) const;

  /// The beacons with settings of their own.
  [[nodiscard]] std::vector<BeaconAddress> beacons() const;

  /// Throws ConfigError if an estimator cannot work with the settings of a beacon.
  void check() const;

  /// Returns warnings about keys of earlier versions and about valid but probably unintended settings: items
  /// 2–4 with a preset that replaces them, and contradictions.
  [[nodiscard]] std::vector<std::string> warnings(OtherEngine other_engine = OtherEngine::warned_of) const;

  /// The complete configuration as a commented TOML file, which loads back to the same values.
  [[nodiscard]] std::string to_toml() const;

  /// The settings that were given, as TOML.
  [[nodiscard]] std::string given_toml() const;

  /// The given settings that have another value in `base`, or that `base` does not have as a beacon's own.
  /// Also those for all beacons that only `base` has, at their values here.
  [[nodiscard]] FusionConfig changes_from(const FusionConfig& base) const;

  /// Number of settings that were given.
  [[nodiscard]] std::size_t given() const;

private:
  void add(const std::filesystem::path& file);
  void set(std::string_view key, const settings::SettingValue& value);

  settings::Settings settings_;
  Assignments given_;  ///< settings that the user gave for all beacons
  std::map<BeaconAddress, Assignments> overrides_;
  std::vector<std::string> unused_;  ///< keys of earlier versions, with file and line, and other files
};

/// The table of all settings as a page of the docs.
std::string settings_page();

/// The settings as lines for a program's help: key, default, what is allowed, and the document's item if
/// there is one. `group` selects a group with its subgroups ("heading", "documented.attitude") or a single
/// key; without it, all. Empty if the name is unknown.
std::string settings_help(const std::string& group = {});

/// The names of all groups, such as "heading" and "documented.attitude.mahony".
std::vector<std::string> settings_groups();

}  // namespace sonopose::config
