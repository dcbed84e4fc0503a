/// The settings' declarations: complete, in range, and refused with a reason.

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

/// The message of the error that `set` throws, having changed nothing.
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
      {1, "fusion.imu_weight"},
      {2, "drift.decay_rate_hz"},
      {3, "velocity.blend_weight"},
      {4, "drift.jump_alpha"},
      {5, "heading.mount_offset_deg"},
      {6, "delay.extrapolate"},
      {7, "velocity.overshoot_fix"},
      {8, "velocity.undershoot_fix"},
      {9, "drift.velocity_smooth_rate_hz"},
      {10, "outage.velocity_decay_rate_hz"},
      {11, "outage.stale_after_s"},
      {12, "admission.min_quality_percent"},
      {13, "trust.sigma_m"},
      {14, "trust.min_weight"},
      {15, "trust.enabled"},
      {16, "trust.reference_innovation_m"},
      {17, "trust.n_base"},
      {18, "trust.n_min"},
      {19, "trust.n_max"},
      {20, "trust.stuck_n"},
      {21, "trust.stuck_jump_scale"},
      {22, "trust.stuck_weight_floor"},
      {23, "runaway.position_error_m"},
      {24, "runaway.velocity_damp_max_hz"},
      {25, "motion.accel_linear_threshold_mps2"},
      {26, "velocity.accel_gate"},
      {27, "velocity.accel_gate_threshold_mps2"},
      {28, "velocity.snap_min_speed_mps"},
      {29, "attitude.mahony.kp"},
      {30, "attitude.mahony.ki"},
      {31, "heading.min_displacement_m"},
      {32, "heading.max_correction_deg"},
      {33, "heading.error_gain"},
      {34, "heading.pair_gain_hz"},
      {35, "motion.gyro_gate"},
      {36, "motion.gyro_gate_projection_radps"},
      {37, "motion.gyro_gate_freeze_radps"},
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
  CHECK(initial("drift.velocity_smooth_rate_hz") >= 10.0);
  CHECK(initial("drift.velocity_smooth_rate_hz") <= 30.0);
  CHECK(initial("trust.sigma_m") >= 0.06);
  CHECK(initial("trust.sigma_m") <= 0.15);
  CHECK(initial("attitude.mahony.ki") >= 0.001);
  CHECK(initial("attitude.mahony.ki") <= 0.01);
  CHECK(initial("motion.gyro_gate_freeze_radps") < 10.0);
  CHECK(initial("delay.processing_s") == 0.068);
  CHECK(std::get<bool>(setting_info("velocity.accel_gate").initial) == false);
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
             Contains("drift.decay_rate") && Contains("drift.decay_rate_hz"));
  CHECK_THAT(refusal("trust.sigmam", 1.0), Contains("trust.sigma_m"));
  CHECK_THAT(refusal("", 1.0), Contains("no setting"));
  CHECK_THROWS_AS(setting_info("drift"), SettingError);
  CHECK_THROWS_AS(get(Settings{}, "drift.nothing"), SettingError);
}

TEST_CASE("a value out of range is refused with key, value and what is allowed") {
  CHECK_THAT(refusal("drift.jump_alpha", 1.5),
             Contains("drift.jump_alpha") && Contains("1.5") && Contains("0 … 1"));
  CHECK_THAT(refusal("trust.n_base", 0), Contains("trust.n_base") && Contains("1 … 1000 fixes"));
  CHECK_THAT(refusal("drift.jump_alpha", std::numeric_limits<double>::quiet_NaN()), Contains("out of range"));
  CHECK_THAT(refusal("drift.jump_alpha", std::numeric_limits<double>::infinity()), Contains("out of range"));
  for (const auto& row : setting_table()) {
    if (!std::holds_alternative<double>(row.initial)) continue;
    const double width = number_of(row.maximum) - number_of(row.minimum);
    refusal(row.key, number_of(row.minimum) - 0.01 * width);
    refusal(row.key, number_of(row.maximum) + 0.01 * width);
    refusal(row.key, std::numeric_limits<double>::quiet_NaN());
  }
}

TEST_CASE("a value of the wrong type is refused") {
  CHECK_THAT(refusal("drift.jump_alpha", std::string("much")), Contains("wrong type") && Contains("much"));
  CHECK_THAT(refusal("drift.jump_alpha", true), Contains("wrong type"));
  CHECK_THAT(refusal("trust.n_base", 2.5), Contains("wrong type"));
  CHECK_THAT(refusal("trust.enabled", 1), Contains("true or false"));
  CHECK_THAT(refusal("fusion.imu_weight", 2), Contains("low, medium, high or user"));
  CHECK_THAT(refusal("fusion.imu_weight", std::string("lowest")), Contains("low, medium, high or user"));
}

TEST_CASE("a whole number serves where a real one is meant") {
  Settings settings;
  set(settings, "drift.decay_rate_hz", 2);
  CHECK(settings.drift.decay_rate_hz == 2.0);
}

TEST_CASE("what is typed becomes a value of the key's kind") {
  CHECK(parse_value("drift.decay_rate_hz", "2.5") == SettingValue(2.5));
  CHECK(parse_value("drift.decay_rate_hz", "2") == SettingValue(2.0));
  CHECK(parse_value("trust.n_base", "12") == SettingValue(12));
  CHECK(parse_value("trust.enabled", "false") == SettingValue(false));
  CHECK(parse_value("fusion.imu_weight", "high") == SettingValue(std::string("high")));
  for (const auto* text : {"", "2.5x", "x", "true", " 2"}) {
    INFO("'" << text << "'");
    CHECK_THROWS_AS(parse_value("drift.decay_rate_hz", text), SettingError);
  }
  CHECK_THROWS_AS(parse_value("trust.n_base", "2.5"), SettingError);
  CHECK_THROWS_AS(parse_value("trust.enabled", "yes"), SettingError);
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
