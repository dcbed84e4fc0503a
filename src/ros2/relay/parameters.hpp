#pragma once
/// \file
/// The settings as ROS 2 parameters: "drift.jump_alpha" for all beacons, "beacon_7.drift.jump_alpha" for one.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Which setting of which beacon, or of all_beacons.
struct SettingName {
  BeaconAddress address = all_beacons;
  std::string key;
  bool operator==(const SettingName&) const = default;
};

/// Empty for what is no parameter's name.
std::optional<SettingName> setting_named(const std::string& parameter);
std::string parameter_name(const SettingName& setting);

/// What is in force, by beacon; all_beacons: what holds for any without values of its own.
using SettingsByBeacon = std::map<BeaconAddress, EffectiveSettings>;

/// Names, and the prefixes that they stand under ("beacon_7.drift").
struct ParameterList {
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
};

/// Those of all beacons and of each that has been heard, as rclcpp lists them: under one of `prefixes`, or
/// all where there is none, and no more than `depth` levels below, unless it is 0.
ParameterList list_parameters(const SettingsByBeacon& in_force, const std::vector<std::string>& prefixes,
                              std::uint64_t depth);

/// Empty for what is no parameter, and for a beacon that was not heard.
std::optional<settings::SettingValue> parameter_value(const SettingsByBeacon& in_force,
                                                      const std::string& parameter);

}  // namespace sonopose::ros2
