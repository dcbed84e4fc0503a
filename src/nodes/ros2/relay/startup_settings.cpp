#include "ros2/relay/startup_settings.hpp"

#include "ros2/relay/parameters.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <stdexcept>

namespace sonopose::ros2::relay {

void check(const StartupSetting& setting) {
  const auto name = setting_named(setting.parameter);
  if (!name)
    throw std::invalid_argument(setting.parameter + ": unknown parameter: " + why_unknown(setting.parameter));
  settings::Settings any;
  settings::set(any, name->key, settings::parse_value(name->key, setting.value));
}

std::vector<SettingsRequest> requests_of(const std::vector<StartupSetting>& settings) {
  std::vector<SettingsRequest> requests;
  const auto request_for = [&](BeaconAddress address) -> SettingsRequest& {
    const auto found = std::find_if(requests.begin(), requests.end(),
                                    [&](const SettingsRequest& each) { return each.address == address; });
    if (found != requests.end()) return *found;
    SettingsRequest request;
    request.address = address;
    // The values of one beacon have precedence over those of all, so they come later.
    return *requests.insert(address == all_beacons ? requests.begin() : requests.end(), request);
  };
  for (const StartupSetting& setting : settings) {
    const auto name = setting_named(setting.parameter);
    if (!name) continue;
    auto& assignments = request_for(name->address).assignments;
    std::erase_if(assignments, [&](const SettingAssignment& each) { return each.key == name->key; });
    assignments.push_back({name->key, setting.value});
  }
  return requests;
}

}  // namespace sonopose::ros2::relay
