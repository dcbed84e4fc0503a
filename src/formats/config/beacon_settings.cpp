#include "config/beacon_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sonopose::config {
namespace {

constexpr std::array<std::string_view, 3> preset_keys{
    "documented.drift.decay_rate_hz", "documented.velocity.blend_weight", "documented.drift.jump_alpha"};

}  // namespace

Assignments parsed(const std::vector<SettingAssignment>& texts) {
  constexpr int max_reasons = 8;  // limits the cost: each may search for the nearest key
  Assignments assignments;
  std::string reasons;
  int refused = 0;
  const auto refuse = [&](const std::string& reason) {
    reasons += (reasons.empty() ? "" : "; also: ") + reason;
    ++refused;
  };
  settings::Settings trial;
  for (const auto& [key, text] : texts) {
    if (refused == max_reasons) {
      reasons += "; the rest was not checked";
      break;
    }
    try {
      const settings::SettingValue value = settings::parse_value(key, text);
      settings::set(trial, key, value);
      if (!assignments.emplace(key, value).second) refuse(key + " is named twice");
    } catch (const settings::SettingError& error) {
      refuse(error.what());
    }
  }
  if (!reasons.empty()) throw settings::SettingError(reasons);
  return assignments;
}

std::vector<SettingAssignment> texts_of(const settings::Settings& settings) {
  std::vector<SettingAssignment> texts;
  for (const auto& row : settings::setting_table()) {
    texts.push_back({row.key, settings::to_text(settings::get(settings, row.key))});
  }
  return texts;
}

std::vector<SettingAssignment> changed_texts_of(const settings::Settings& settings) {
  std::vector<SettingAssignment> texts;
  for (const auto& row : settings::setting_table()) {
    const settings::SettingValue value = settings::get(settings, row.key);
    if (value != row.initial) texts.push_back({row.key, settings::to_text(value)});
  }
  return texts;
}

bool is_preset_key(std::string_view key) {
  return std::find(preset_keys.begin(), preset_keys.end(), key) != preset_keys.end();
}

std::vector<std::string> preset_warnings(const settings::Settings& settings, const Assignments& given,
                                         std::string_view where) {
  std::vector<std::string> texts;
  if (settings.preset.imu_weight == settings::ImuWeight::user) return texts;
  for (const auto key : preset_keys) {
    if (!given.contains(key)) continue;
    texts.push_back(
        fmt::format("{}{} is ignored: documented.imu_weight = {} sets it; use documented.imu_weight = user",
                    where, key, settings::to_text(settings::get(settings, "documented.imu_weight"))));
  }
  return texts;
}

void BeaconSettings::assign_for_all(const Assignments& assignments) {
  for (const auto& [key, value] : assignments) {
    if (!own_.contains(key)) settings::set(settings_, key, value);
  }
}

void BeaconSettings::assign_own(const Assignments& assignments) {
  for (const auto& [key, value] : assignments) {
    settings::set(settings_, key, value);
    own_.insert(key);
  }
}

std::vector<SettingAssignment> BeaconSettings::own_texts() const {
  std::vector<SettingAssignment> texts;
  for (const std::string& key : own_) {
    texts.push_back({key, settings::to_text(settings::get(settings_, key))});
  }
  return texts;
}

}  // namespace sonopose::config
