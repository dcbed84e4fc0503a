/// Declarations of the settings: complete, in range, and refused with a reason.

#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <map>
#include <set>

namespace settings_test {

using namespace sonopose::settings;
using Catch::Matchers::Contains;

double number_of(const SettingValue& value) {
  if (const auto* whole = std::get_if<int>(&value)) return *whole;
  return std::get<double>(value);
}

bool is_number(const SettingInfo& row) {
  return std::holds_alternative<int>(row.initial) || std::holds_alternative<double>(row.initial);
}

bool same_everywhere(const Settings& a, const Settings& b) {
  for (const auto& row : setting_table()) {
    if (get(a, row.key) != get(b, row.key)) return false;
  }
  return true;
}

/// Message of the error that `set` throws; checks that nothing changed.
std::string refusal(std::string_view key, const SettingValue& value) {
  Settings settings;
  try {
    set(settings, key, value);
  } catch (const SettingError& error) {
    CHECK(same_everywhere(settings, Settings{}));
    return error.what();
  }
  FAIL("accepted: " << key << " = " << to_text(value));
  return {};
}

TEST_CASE("each of the document's 37 items is declared exactly once") {
  std::map<int, int> times;
  for (const auto& row : setting_table()) ++times[row.item];
  for (int item = 1; item <= 37; ++item) {
    INFO("item " << item);
    CHECK(times[item] == 1);
  }
  times.erase(no_item);
  CHECK(times.size() == 37);
}

TEST_CASE("the items stand under the documented keys") {
  const std::map<int, std::string> keys{
      {1, "documented.imu_weight"},
      {2, "documented.drift.decay_rate_hz"},
      {3, "documented.velocity.blend_weight"},
      {4, "documented.drift.jump_alpha"},
      {5, "heading.mount_offset_deg"},
      {6, "delay.extrapolate"},
      {7, "documented.velocity.overshoot_fix"},
      {8, "documented.velocity.undershoot_fix"},
      {9, "documented.drift.velocity_smooth_rate_hz"},
      {10, "documented.outage.velocity_decay_rate_hz"},
      {11, "outage.stale_after_s"},
      {12, "admission.min_quality_percent"},
      {13, "documented.trust.sigma_m"},
      {14, "documented.trust.min_weight"},
      {15, "documented.trust.enabled"},
      {16, "documented.trust.reference_innovation_m"},
      {17, "documented.trust.n_base"},
      {18, "documented.trust.n_min"},
      {19, "documented.trust.n_max"},
      {20, "documented.trust.stuck_n"},
      {21, "documented.trust.stuck_jump_scale"},
      {22, "documented.trust.stuck_weight_floor"},
      {23, "documented.runaway.position_error_m"},
      {24, "documented.runaway.velocity_damp_max_hz"},
      {25, "documented.motion.accel_linear_threshold_mps2"},
      {26, "documented.velocity.accel_gate"},
      {27, "documented.velocity.accel_gate_threshold_mps2"},
      {28, "documented.velocity.snap_min_speed_mps"},
      {29, "documented.attitude.mahony.kp"},
      {30, "documented.attitude.mahony.ki"},
      {31, "documented.heading.min_displacement_m"},
      {32, "documented.heading.max_correction_deg"},
      {33, "documented.heading.error_gain"},
      {34, "documented.heading.pair_gain_hz"},
      {35, "documented.motion.gyro_gate"},
      {36, "documented.motion.gyro_gate_projection_radps"},
      {37, "documented.motion.gyro_gate_freeze_radps"},
  };
  for (const auto& [item, key] : keys) CHECK(setting_info(key).item == item);
}

TEST_CASE("every row is complete, its key unique and its default in its range") {
  std::set<std::string> keys;
  const Settings defaults;
  for (const auto& row : setting_table()) {
    INFO(row.key);
    CHECK(keys.insert(row.key).second);
    CHECK(row.key == row.group + "." + row.name);
    CHECK(row.sentence.size() > 10);
    CHECK(row.sentence.back() == '.');
    CHECK(get(defaults, row.key) == row.initial);
    if (is_number(row)) {
      CHECK(number_of(row.minimum) < number_of(row.maximum));
      CHECK(number_of(row.initial) >= number_of(row.minimum));
      CHECK(number_of(row.initial) <= number_of(row.maximum));
    }
  }
}

TEST_CASE("the defaults stay within the document's typical ranges") {
  const auto initial = [](const char* key) { return number_of(setting_info(key).initial); };
  CHECK(initial("documented.drift.velocity_smooth_rate_hz") >= 10.0);
  CHECK(initial("documented.drift.velocity_smooth_rate_hz") <= 30.0);
  CHECK(initial("documented.trust.sigma_m") >= 0.06);
  CHECK(initial("documented.trust.sigma_m") <= 0.15);
  CHECK(initial("documented.attitude.mahony.ki") >= 0.001);
  CHECK(initial("documented.attitude.mahony.ki") <= 0.01);
  CHECK(initial("documented.motion.gyro_gate_freeze_radps") < 10.0);
  CHECK(initial("delay.processing_s") == 0.068);
  CHECK(std::get<bool>(setting_info("documented.velocity.accel_gate").initial) == false);
}

TEST_CASE("every setting can be set to both ends of its range and read back") {
  for (const auto& row : setting_table()) {
    INFO(row.key);
    Settings settings;
    if (is_number(row)) {
      for (const auto& value : {row.minimum, row.maximum}) {
        set(settings, row.key, value);
        CHECK(get(settings, row.key) == value);
      }
    } else if (row.choices.empty()) {
      for (const bool value : {true, false}) {
        set(settings, row.key, value);
        CHECK(get(settings, row.key) == SettingValue(value));
      }
    } else {
      for (const auto choice : row.choices) {
        set(settings, row.key, std::string(choice));
        CHECK(get(settings, row.key) == SettingValue(std::string(choice)));
      }
    }
  }
}

TEST_CASE("setting one changes that one alone") {
  for (const auto& row : setting_table()) {
    if (!is_number(row)) continue;
    Settings settings;
    set(settings, row.key, row.maximum);
    for (const auto& other : setting_table()) {
      if (other.key != row.key) CHECK(get(settings, other.key) == other.initial);
    }
  }
}

TEST_CASE("an unknown key is refused and names the nearest") {
  CHECK_THAT(refusal("drift.decay_rate", 1.0),
             Contains("drift.decay_rate") && Contains("documented.drift.decay_rate_hz"));
  CHECK_THAT(refusal("trust.sigmam", 1.0), Contains("documented.trust.sigma_m"));
  CHECK_THAT(refusal("", 1.0), Contains("no setting"));
  CHECK_THROWS_AS(setting_info("drift"), SettingError);
  CHECK_THROWS_AS(get(Settings{}, "drift.nothing"), SettingError);
}

TEST_CASE("an old key is answered by the new name") {
  Settings settings;
  CHECK_THROWS_WITH(set(settings, "trust.sigma_m", 0.2),
                    "'trust.sigma_m' is now called 'documented.trust.sigma_m'");
  CHECK_THROWS_WITH(get(settings, "fusion.imu_weight"),
                    "'fusion.imu_weight' is now called 'documented.imu_weight'");
  CHECK_THROWS_WITH(get(settings, "delay.estimate"),
                    "'delay.estimate' is now called 'kalman.delay.estimate'");
}

TEST_CASE("a key says which engine reads it, and the shared ones come first") {
  const auto& table = setting_table();
  CHECK(std::is_sorted(table.begin(), table.end(), [](const SettingInfo& a, const SettingInfo& b) {
    const auto rank = [](ReadBy by) { return by == ReadBy::all ? 0 : by == ReadBy::kalman ? 1 : 2; };
    return rank(a.read_by) < rank(b.read_by);
  }));
  for (const SettingInfo& row : table) {
    CAPTURE(row.key);
    CHECK(row.key.starts_with("documented.") == (row.read_by == ReadBy::documented));
    CHECK(row.key.starts_with("kalman.") == (row.read_by == ReadBy::kalman));
  }
}

TEST_CASE("a value out of range is refused with key, value and what is allowed") {
  CHECK_THAT(refusal("documented.drift.jump_alpha", 1.5),
             Contains("documented.drift.jump_alpha") && Contains("1.5") && Contains("0 … 1"));
  CHECK_THAT(refusal("documented.trust.n_base", 0),
             Contains("documented.trust.n_base") && Contains("1 … 1000 fixes"));
  CHECK_THAT(refusal("documented.drift.jump_alpha", std::numeric_limits<double>::quiet_NaN()),
             Contains("out of range"));
  CHECK_THAT(refusal("documented.drift.jump_alpha", std::numeric_limits<double>::infinity()),
             Contains("out of range"));
  for (const auto& row : setting_table()) {
    if (!std::holds_alternative<double>(row.initial)) continue;
    const double width = number_of(row.maximum) - number_of(row.minimum);
    refusal(row.key, number_of(row.minimum) - 0.01 * width);
    refusal(row.key, number_of(row.maximum) + 0.01 * width);
    refusal(row.key, std::numeric_limits<double>::quiet_NaN());
  }
}

TEST_CASE("a value of the wrong type is refused") {
  CHECK_THAT(refusal("documented.drift.jump_alpha", std::string("much")),
             Contains("wrong type") && Contains("much"));
  CHECK_THAT(refusal("documented.drift.jump_alpha", true), Contains("wrong type"));
  CHECK_THAT(refusal("documented.trust.n_base", 2.5), Contains("wrong type"));
  CHECK_THAT(refusal("documented.trust.enabled", 1), Contains("true or false"));
  CHECK_THAT(refusal("documented.imu_weight", 2), Contains("low, medium, high or user"));
  CHECK_THAT(refusal("documented.imu_weight", std::string("lowest")), Contains("low, medium, high or user"));
}

TEST_CASE("a whole number serves where a real one is meant") {
  Settings settings;
  set(settings, "documented.drift.decay_rate_hz", 2);
  CHECK(settings.drift.decay_rate_hz == 2.0);
}

TEST_CASE("what is typed becomes a value of the key's kind") {
  CHECK(parse_value("documented.drift.decay_rate_hz", "2.5") == SettingValue(2.5));
  CHECK(parse_value("documented.drift.decay_rate_hz", "2") == SettingValue(2.0));
  CHECK(parse_value("documented.trust.n_base", "12") == SettingValue(12));
  CHECK(parse_value("documented.trust.enabled", "false") == SettingValue(false));
  CHECK(parse_value("documented.imu_weight", "high") == SettingValue(std::string("high")));
  for (const auto* text : {"", "2.5x", "x", "true", " 2"}) {
    INFO("'" << text << "'");
    CHECK_THROWS_AS(parse_value("documented.drift.decay_rate_hz", text), SettingError);
  }
  CHECK_THROWS_AS(parse_value("documented.trust.n_base", "2.5"), SettingError);
  CHECK_THROWS_AS(parse_value("documented.trust.enabled", "yes"), SettingError);
  CHECK_THROWS_AS(parse_value("trust.enable", "true"), SettingError);
}

TEST_CASE("a value as text reads back as itself") {
  for (const auto& row : setting_table()) {
    CHECK(parse_value(row.key, to_text(row.initial)) == row.initial);
  }
  CHECK(to_text(0.1) == "0.1");
  CHECK(to_text(true) == "true");
  CHECK(to_text(7) == "7");
}

}  // namespace settings_test
