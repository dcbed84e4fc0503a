#include "config/beacon_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

namespace sonopose::config {
namespace {

/// Two settings, of which the first must stay below the second or, optionally, may equal it.
struct Order {
  std::string_view smaller;
  std::string_view larger;
  bool may_be_equal;
  std::string_view part_of;  ///< switch that activates both; may be empty
  std::string_view otherwise;
};

constexpr std::array<Order, 5> orders{{
    {"documented.velocity.interval_min_s", "documented.velocity.interval_max_s", true, "",
     "no pair of fixes meets both limits, so the velocity is never corrected"},
    {"documented.velocity.interval_wanted_s", "documented.velocity.interval_max_s", true, "",
     "the wanted interval is never reached; the velocity is measured over the maximum interval"},
    {"documented.trust.n_min", "documented.trust.n_max", true, "documented.trust.enabled",
     "the track is accepted after documented.trust.n_max fixes, before trust is rebuilt"},
    {"documented.trust.stuck_n", "documented.trust.n_max", false, "documented.trust.enabled",
     "the track is accepted after documented.trust.n_max fixes, so convergence is never forced"},
    {"documented.motion.gyro_gate_projection_radps", "documented.motion.gyro_gate_freeze_radps", true,
     "documented.motion.gyro_gate", "the acceleration is ignored from the latter on and never projected"},
}};

/// A settings group that only one attitude filter reads.
struct FilterGroup {
  std::string_view group;
  std::string_view filter;
};

constexpr std::array<FilterGroup, 7> filter_groups{{{"documented.attitude.adaptive", "adaptive"},
                                                    {"documented.attitude.rest", "adaptive"},
                                                    {"documented.attitude.bias", "adaptive"},
                                                    {"documented.attitude.magnetic", "adaptive"},
                                                    {"documented.attitude.mahony", "mahony"},
                                                    {"documented.attitude.complementary", "complementary"},
                                                    {"documented.attitude.ahrs", "ahrs"}}};

/// Keys that are read only if the magnetometer is used.
constexpr std::array<std::string_view, 5> magnetometer_keys{
    "documented.attitude.north_deg", "documented.attitude.adaptive.heading_time_s",
    "documented.attitude.mahony.magnetic_error", "documented.attitude.mahony.heading_kp",
    "documented.attitude.ahrs.magnetic_rejection_deg"};

bool is_for_magnetometer(const settings::SettingInfo& info) {
  return info.group == "documented.attitude.magnetic" ||
         std::find(magnetometer_keys.begin(), magnetometer_keys.end(), info.key) != magnetometer_keys.end();
}

double value_of(const settings::Settings& settings, std::string_view key) {
  const settings::SettingValue value = settings::get(settings, key);
  const auto* whole = std::get_if<int>(&value);
  return whole != nullptr ? *whole : std::get<double>(value);
}

bool is_kept(const settings::Settings& settings, const Order& order) {
  if (!order.part_of.empty() && !std::get<bool>(settings::get(settings, order.part_of))) return true;
  const double smaller = value_of(settings, order.smaller);
  const double larger = value_of(settings, order.larger);
  return smaller < larger || (order.may_be_equal && smaller == larger);
}

/// Returns the reader of the settings that have no effect with this engine.
settings::ReadBy other_than(settings::EngineKind engine) {
  return engine == settings::EngineKind::documented ? settings::ReadBy::kalman : settings::ReadBy::documented;
}

/// Returns one warning about all `given` keys that differ from their default and that only the other engine
/// reads; empty if there are none.
std::string other_engine_warning(const settings::Settings& settings, const Assignments& given,
                                 std::string_view where) {
  const settings::ReadBy unread = other_than(settings.engine.engine);
  std::vector<std::string> keys;
  for (const auto& entry : given) {
    const settings::SettingInfo& info = settings::setting_info(entry.first);
    // Read back in the setting's own type: an integer may have been given for a real number.
    if (info.read_by != unread || settings::get(settings, entry.first) == info.initial) continue;
    keys.push_back(fmt::format("{}{}", where, entry.first));
  }
  if (keys.empty()) return {};
  constexpr std::size_t max_named = 3;
  const std::size_t more = keys.size() - std::min(keys.size(), max_named);
  keys.resize(keys.size() - more);
  return fmt::format("{}{} {} no effect: fusion.engine is {}", fmt::join(keys, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "", keys.size() > 1 ? "have" : "has",
                     settings::to_text(settings::get(settings, "fusion.engine")));
}

}  // namespace

std::vector<std::string> contradictions(const settings::Settings& settings, const Assignments& given,
                                        std::string_view where) {
  const auto is_given = [&given](std::string_view key) { return given.contains(key); };
  const auto text_of = [&](std::string_view key) {
    return fmt::format("{}{} = {}", where, key, settings::to_text(settings::get(settings, key)));
  };
  std::vector<std::string> texts;
  for (const Order& order : orders) {
    if (is_kept(settings, order)) continue;
    if (!is_given(order.smaller) && !is_given(order.larger) && !is_given(order.part_of)) continue;
    texts.push_back(fmt::format("{} is {} {}: {}", text_of(order.smaller),
                                order.may_be_equal ? "above" : "not below", text_of(order.larger),
                                order.otherwise));
  }
  return texts;
}

std::vector<std::string> idle_filter_warnings(const settings::Settings& settings, const Assignments& given,
                                              std::string_view where) {
  const std::string chosen = settings::to_text(settings::get(settings, "documented.attitude.filter"));
  const bool magnetometer = std::get<bool>(settings::get(settings, "documented.attitude.magnetometer"));
  std::vector<std::string> texts;
  for (const auto& entry : given) {
    const std::string& key = entry.first;
    const settings::SettingInfo& info = settings::setting_info(key);
    // Read back in the setting's own type: an integer may have been given for a real number.
    const settings::SettingValue value = settings::get(settings, key);
    if (value == info.initial) continue;
    const auto owner = std::find_if(filter_groups.begin(), filter_groups.end(),
                                    [&info](const FilterGroup& group) { return group.group == info.group; });
    const auto warn = [&](const std::string& why) {
      texts.push_back(fmt::format("{}{} = {} has no effect: {}", where, key, settings::to_text(value), why));
    };
    if (owner != filter_groups.end() && owner->filter != chosen) {
      warn(fmt::format("documented.attitude.filter is {}, not {}", chosen, owner->filter));
    } else if (!magnetometer && is_for_magnetometer(info)) {
      warn("documented.attitude.magnetometer is false");
    }
  }
  return texts;
}

std::string fault_of(const settings::Settings& settings) {
  if (settings.engine.engine == settings::EngineKind::kalman && settings.attitude.selection.magnetometer) {
    return "documented.attitude.magnetometer = true, but fusion.engine is kalman, which uses no "
           "magnetometer; set "
           "fusion.engine = documented or documented.attitude.magnetometer = false";
  }
  return {};
}

std::vector<std::string> warnings_for(const settings::Settings& settings, const Assignments& given,
                                      std::string_view where, OtherEngine other_engine) {
  std::vector<std::string> texts;
  if (other_engine == OtherEngine::warned_of) {
    std::string text = other_engine_warning(settings, given, where);
    if (!text.empty()) texts.push_back(std::move(text));
  }
  if (settings.engine.engine != settings::EngineKind::documented) return texts;
  for (std::string& text : preset_warnings(settings, given, where)) texts.push_back(std::move(text));
  for (std::string& text : contradictions(settings, given, where)) texts.push_back(std::move(text));
  for (std::string& text : idle_filter_warnings(settings, given, where)) texts.push_back(std::move(text));
  return texts;
}

std::vector<std::string> warnings_for_all(const settings::Settings& common, const Assignments& given,
                                          const std::map<BeaconAddress, settings::Settings>& own,
                                          OtherEngine other_engine) {
  std::map<std::string, std::vector<BeaconAddress>> others;  // warnings for beacons with another engine
  Assignments of_common = given;
  for (const auto& [address, settings] : own) {
    if (settings.engine.engine == common.engine.engine) continue;
    Assignments applied = given;
    std::erase_if(applied, [&, &settings = settings](const auto& entry) {
      return settings::get(settings, entry.first) != settings::get(common, entry.first);
    });
    std::erase_if(of_common, [&](const auto& entry) {  // this beacon reads them
      return applied.contains(entry.first) &&
             settings::setting_info(entry.first).read_by == other_than(common.engine.engine);
    });
    for (std::string& text : warnings_for(settings, applied, "", other_engine)) {
      others[std::move(text)].push_back(address);
    }
  }
  std::vector<std::string> texts = warnings_for(common, of_common, "", other_engine);
  for (const auto& [text, addresses] : others) {
    texts.push_back(fmt::format("beacon {}: {}", fmt::join(addresses, ", "), text));
  }
  return texts;
}

}  // namespace sonopose::config
