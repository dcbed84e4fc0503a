#pragma once
/// \file
/// Settings as ROS 2 parameters: "documented.drift.jump_alpha" for all beacons,
/// "beacon_7.documented.drift.jump_alpha" for one.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sonopose::ros2::relay {

/// A setting of one beacon, or of all_beacons.
struct SettingName {
  BeaconAddress address = all_beacons;
  std::string key;
  bool operator==(const SettingName&) const = default;
};

/// The setting of a parameter; empty if `parameter` is not the name of one.
std::optional<SettingName> setting_named(const std::string& parameter);

/// The reason why `setting_named` finds none, with the nearest name, or the new one of an old name.
std::string why_unknown(const std::string& parameter);
std::string parameter_name(const SettingName& setting);

/// Options of the relay by parameter name: read-only parameters, a list as numbers or texts.
using OptionValue = std::variant<settings::SettingValue, std::vector<double>, std::vector<std::string>>;
using OptionParameters = std::map<std::string, OptionValue>;

/// Effective settings by beacon; all_beacons: defaults of all beacons.
using SettingsByBeacon = std::map<BeaconAddress, EffectiveSettings>;

/// Parameter names, and their prefixes ("beacon_7.documented.drift").
struct ParameterList {
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
};

/// Lists options, and parameters of all_beacons and of each known beacon, with the semantics of rclcpp: those
/// below one of `prefixes` (all if empty), at most `depth` levels deep (0: no limit).
ParameterList list_parameters(const SettingsByBeacon& effective, const std::vector<std::string>& prefixes,
                              std::uint64_t depth, const OptionParameters& options = {});

/// Parsed value; empty if this version does not accept it. Settings come from any process.
std::optional<settings::SettingValue> valid_value(const SettingAssignment& setting);

/// Value of a parameter; empty for an unknown parameter or beacon, and for an invalid value.
std::optional<settings::SettingValue> parameter_value(const SettingsByBeacon& effective,
                                                      const std::string& parameter);

}  // namespace sonopose::ros2::relay
