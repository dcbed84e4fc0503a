#include "ros2/relay/parameters.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace sonopose::ros2::relay {
namespace {

constexpr std::string_view beacon_prefix = "beacon_";

bool is_setting(const std::string& key) {
  const auto& table = settings::setting_table();
  return std::any_of(table.begin(), table.end(), [&](const auto& info) { return info.key == key; });
}

/// True if `name` has at most `depth` levels; 0: no limit.
bool within_depth(std::string_view name, std::uint64_t depth) {
  return depth == 0 || static_cast<std::uint64_t>(std::count(name.begin(), name.end(), '.')) < depth;
}

bool is_selected(const std::string& name, const std::vector<std::string>& prefixes, std::uint64_t depth) {
  if (prefixes.empty()) return within_depth(name, depth);
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
    if (name == prefix) return true;
    return name.starts_with(prefix) && name[prefix.size()] == '.' &&
           within_depth(std::string_view(name).substr(prefix.size() + 1), depth);
  });
}

}  // namespace

std::optional<SettingName> setting_named(const std::string& parameter) {
  SettingName setting{.address = all_beacons, .key = parameter};
  if (parameter.starts_with(beacon_prefix)) {
    const char* const begin = parameter.data() + beacon_prefix.size();
    const char* const end = parameter.data() + parameter.size();
    const auto [dot, error] = std::from_chars(begin, end, setting.address);
    if (error != std::errc() || dot == end || *dot != '.') return std::nullopt;
    setting.key = std::string(dot + 1, end);
    if (setting.address == all_beacons || parameter_name(setting) != parameter) return std::nullopt;
  }
  if (!is_setting(setting.key)) return std::nullopt;
  return setting;
}

std::string why_unknown(const std::string& parameter) {
  std::string_view key = parameter;
  if (key.starts_with(beacon_prefix)) key.remove_prefix(std::min(key.size(), key.find('.') + 1));
  try {
    settings::setting_info(key);
  } catch (const settings::SettingError& error) {
    return error.what();
  }
  return "the address of its beacon is invalid";
}

std::string parameter_name(const SettingName& setting) {
  if (setting.address == all_beacons) return setting.key;
  return std::string(beacon_prefix) + std::to_string(setting.address) + "." + setting.key;
}

std::optional<settings::SettingValue> valid_value(const SettingAssignment& setting) {
  try {
    return settings::parse_value(setting.key, setting.value);
  } catch (const settings::SettingError&) {
    return std::nullopt;
  }
}

ParameterList list_parameters(const SettingsByBeacon& effective, const std::vector<std::string>& prefixes,
                              std::uint64_t depth, const OptionParameters& options) {
  ParameterList list;
  for (const auto& entry : options) {
    if (is_selected(entry.first, prefixes, depth)) list.names.push_back(entry.first);
  }
  for (const auto& [address, settings] : effective) {
    for (const auto& setting : settings.values) {
      if (!valid_value(setting)) continue;
      const std::string name = parameter_name({address, setting.key});
      if (!is_selected(name, prefixes, depth)) continue;
      list.names.push_back(name);
      const std::string prefix = name.substr(0, name.rfind('.'));
      // The settings of a group follow one another.
      if (std::find(list.prefixes.rbegin(), list.prefixes.rend(), prefix) == list.prefixes.rend()) {
        list.prefixes.push_back(prefix);
      }
    }
  }
  return list;
}

std::optional<settings::SettingValue> parameter_value(const SettingsByBeacon& effective,
                                                      const std::string& parameter) {
  const auto setting = setting_named(parameter);
  if (!setting) return std::nullopt;
  const auto beacon = effective.find(setting->address);
  if (beacon == effective.end()) return std::nullopt;
  const auto& values = beacon->second.values;
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const SettingAssignment& each) { return each.key == setting->key; });
  if (found == values.end()) return std::nullopt;
  return valid_value(*found);
}

}  // namespace sonopose::ros2::relay
