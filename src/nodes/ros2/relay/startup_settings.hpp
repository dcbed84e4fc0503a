#pragma once
/// \file
/// Settings that the command line of the relay gives to the fusion.

#include <sonopose/samples/live_settings.hpp>

#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// A parameter by its ROS name, which is that of a setting (setting_named), and its value as text.
struct StartupSetting {
  std::string parameter;
  std::string value;
};

/// Throws std::invalid_argument for an invalid value, and for a parameter that is no setting.
void check(const StartupSetting& setting);

/// One request per beacon, preceded by that for all beacons. The last of several values of a parameter
/// counts.
std::vector<SettingsRequest> requests_of(const std::vector<StartupSetting>& settings);

}  // namespace sonopose::ros2::relay
