#include "config/learned_file.hpp"

#include "config/beacon_settings.hpp"
#include "config/fusion_config.hpp"
#include "toml/leaves.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <set>
#include <string_view>

namespace sonopose::config {
namespace {

struct VectorField {
  std::string_view value_key;
  std::string_view std_key;
  std::optional<VectorEstimate> Estimate::*field;
};

constexpr std::array<VectorField, 3> vector_fields{
    {{"gyro_bias_body_radps", "gyro_bias_std_radps", &Estimate::gyro_bias_body_radps},
     {"accel_bias_body_mps2", "accel_bias_std_mps2", &Estimate::accelerometer_bias_body_mps2},
     {"lever_arm_body_m", "lever_arm_std_m", &Estimate::lever_arm_body_m}}};
constexpr std::string_view time_key = "time_ns";
constexpr std::string_view fix_std_key = "fix_std_m";
constexpr std::string_view mounting_key = "mounting";

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<Vector3d> vector_in(const toml::Value& value) {
  const auto* const words = std::get_if<toml::Words>(&value);
  if (words == nullptr || words->size() != 3) return std::nullopt;
  Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    const auto number = number_in<double>((*words)[static_cast<std::size_t>(i)]);
    if (!number) return std::nullopt;
    vector[i] = *number;
  }
  return vector;
}

/// True for what mounting_of() writes: it has no characters that TOML escapes.
bool is_assignment(std::string_view text) {
  return text.find('=') != text.npos &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_.=+-") == text.npos;
}

/// Sets one value. Returns what was expected if it cannot.
std::string_view set(LearnedBeacon& learned, std::string_view key, const toml::Value& value) {
  Estimate& estimate = learned.estimate;
  if (key == mounting_key) {
    const auto* const words = std::get_if<toml::Words>(&value);
    if (words == nullptr || !std::ranges::all_of(*words, is_assignment)) return "an array of \"KEY=VALUE\"";
    learned.mounting = *words;
    return "";
  }
  if (key == time_key) {
    const auto* const time_ns = std::get_if<std::int64_t>(&value);
    if (time_ns != nullptr) estimate.time_ns = *time_ns;
    return time_ns == nullptr ? "an integer" : "";
  }
  if (key == fix_std_key) {
    const auto number = toml::text_of(value);
    const auto std_m = number_in<double>(number);
    if (std_m) estimate.fix_noise_m = ScalarEstimate{.value = *std_m, .std = -1.0};
    return std_m ? "" : "a number";
  }
  for (const VectorField& field : vector_fields) {
    if (key != field.value_key && key != field.std_key) continue;
    const auto vector = vector_in(value);
    if (!vector) return "three numbers";
    auto& known = estimate.*field.field;
    if (!known) known = VectorEstimate{.value = Vector3d::Zero(), .std = Vector3d::Constant(-1.0)};
    (key == field.value_key ? known->value : known->std) = *vector;
    return "";
  }
  return "a key of this file";
}

std::string line_of(std::string_view key, const Vector3d& value) {
  return fmt::format("{} = [{}, {}, {}]\n", key, value.x(), value.y(), value.z());
}

}  // namespace

std::vector<std::string> mounting_of(const settings::Settings& settings) {
  std::vector<std::string> mounting;
  for (const SettingAssignment& changed : changed_texts_of(settings)) {
    if (!changed.key.starts_with("calibration.") && changed.key != "heading.mount_offset_deg") continue;
    mounting.push_back(fmt::format("{}={}", changed.key, changed.value));
  }
  return mounting;
}

LearnedSensors read_learned(const std::filesystem::path& file) {
  constexpr std::string_view prefix = "beacon.";
  LearnedSensors learned;
  std::set<BeaconAddress> mounted;
  if (std::error_code ignored; !std::filesystem::exists(file, ignored)) return learned;
  const auto leaves = [&] {
    try {
      return toml::read_leaves(file);
    } catch (const files::IoError& error) {
      throw ConfigError(error.what());
    }
  }();
  for (const toml::Leaf& leaf : leaves) {
    const std::string_view key = leaf.key;
    const std::size_t dot = key.find('.', prefix.size());
    const auto address = key.starts_with(prefix) && dot != std::string_view::npos
                             ? number_in<BeaconAddress>(key.substr(prefix.size(), dot - prefix.size()))
                             : std::nullopt;
    const std::string_view expected =
        address ? set(learned[*address], key.substr(dot + 1), leaf.value) : "beacon.ADDRESS.KEY";
    if (!expected.empty()) {
      throw ConfigError(fmt::format("{}:{}: {}: expected {}", file.string(), leaf.line, leaf.key, expected));
    }
    if (key.substr(dot + 1) == mounting_key) mounted.insert(*address);
  }
  for (auto& [address, beacon] : learned) {
    beacon.estimate.address = address;
    if (mounted.contains(address)) continue;
    throw ConfigError(fmt::format("{}: beacon.{}.{} is missing", file.string(), address, mounting_key));
  }
  return learned;
}

std::string learned_toml(const LearnedSensors& learned) {
  std::string text = "# Written by sonopose-fusion for its next start. Delete it to begin without.\n";
  for (const auto& [address, beacon] : learned) {
    const Estimate& estimate = beacon.estimate;
    text += fmt::format("\n[beacon.{}]\n{} = {}\n", address, time_key, estimate.time_ns);
    text += fmt::format(
        "{} = [{}]\n", mounting_key,
        beacon.mounting.empty() ? "" : fmt::format("\"{}\"", fmt::join(beacon.mounting, "\", \"")));
    for (const VectorField& field : vector_fields) {
      const auto& known = estimate.*field.field;
      if (known) text += line_of(field.value_key, known->value) + line_of(field.std_key, known->std);
    }
    if (estimate.fix_noise_m) text += fmt::format("{} = {}\n", fix_std_key, estimate.fix_noise_m->value);
  }
  return text;
}

}  // namespace sonopose::config
