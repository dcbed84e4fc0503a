#include <sonopose/config/beacon_settings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sonopose::config {
namespace {

constexpr std::array<std::string_view, 3> preset_keys{"drift.decay_rate_hz", "velocity.blend_weight",
                                                      "drift.jump_alpha"};

}  // namespace

Assignments parsed(const std::vector<SettingAssignment>& texts) {
  Assignments assignments;
  std::string reasons;
  const auto refuse = [&reasons](const std::string& reason) {
    reasons += (reasons.empty() ? "" : "; also: ") + reason;
  };
  fusion::Settings trial;
  for (const auto& [key, text] : texts) {
    try {
      const fusion::SettingValue value = fusion::parse_value(key, text);
      fusion::set(trial, key, value);
      if (!assignments.emplace(key, value).second) refuse(key + " is named twice");
    } catch (const fusion::SettingError& error) {
      refuse(error.what());
    }
  }
  if (!reasons.empty()) throw fusion::SettingError(reasons);
  return assignments;
}

std::vector<SettingAssignment> texts_of(const fusion::Settings& settings) {
  std::vector<SettingAssignment> texts;
  for (const auto& row : fusion::setting_table()) {
    texts.push_back({row.key, fusion::to_text(fusion::get(settings, row.key))});
  }
  return texts;
}

bool is_preset_key(std::string_view key) {
  return std::find(preset_keys.begin(), preset_keys.end(), key) != preset_keys.end();
}

std::vector<std::string> preset_warnings(const fusion::Settings& settings, const Assignments& given,
                                         std::string_view where) {
  std::vector<std::string> texts;
  if (settings.preset.imu_weight == fusion::ImuWeight::user) return texts;
  for (const auto key : preset_keys) {
    if (!given.contains(key)) continue;
    texts.push_back(
        fmt::format("{}{} is ignored: fusion.imu_weight = {} sets it; use fusion.imu_weight = user", where,
                    key, fusion::to_text(fusion::get(settings, "fusion.imu_weight"))));
  }
  return texts;
}

void BeaconSettings::assign_for_all(const Assignments& assignments) {
  for (const auto& [key, value] : assignments) {
    if (!own_.contains(key)) fusion::set(settings_, key, value);
  }
}

void BeaconSettings::assign_own(const Assignments& assignments) {
  for (const auto& [key, value] : assignments) {
    fusion::set(settings_, key, value);
    own_.insert(key);
  }
}

}  // namespace sonopose::config
