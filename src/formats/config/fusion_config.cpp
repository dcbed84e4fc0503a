#include "config/fusion_config.hpp"

#include "toml/leaves.hpp"
#include <sonopose/settings/preset.hpp>

#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <utility>

namespace sonopose::config {
namespace {

using settings::SettingError;
using settings::SettingValue;

constexpr std::string_view beacon_prefix = "beacon.";

/// Converts a value of the TOML file to a setting's value.
SettingValue value_of(const toml::Leaf& leaf) {
  if (const auto* flag = std::get_if<bool>(&leaf.value)) return *flag;
  if (const auto* whole = std::get_if<std::int64_t>(&leaf.value)) {
    if (std::in_range<int>(*whole)) return static_cast<int>(*whole);
    return static_cast<double>(*whole);  // beyond every range, so it will be refused
  }
  if (const auto* real = std::get_if<double>(&leaf.value)) return *real;
  if (const auto* text = std::get_if<std::string>(&leaf.value)) return *text;
  throw SettingError(fmt::format("{}: neither a number, true or false, nor a text", leaf.key));
}

std::vector<toml::Leaf> leaves_of(const std::filesystem::path& file) {
  try {
    return toml::read_leaves(file);
  } catch (const files::IoError& error) {
    throw ConfigError(error.what());
  }
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& file,
                                            const std::filesystem::path& without) {
  try {
    return toml::with_drop_ins(file, without);
  } catch (const files::IoError& error) {
    throw ConfigError(error.what());
  }
}

/// Splits "beacon.7.documented.drift.decay_rate_hz" at the address.
std::pair<BeaconAddress, std::string_view> split_beacon(std::string_view key) {
  const std::string_view rest = key.substr(beacon_prefix.size());
  const std::size_t dot = rest.find('.');
  const std::string_view number = rest.substr(0, dot);
  BeaconAddress address = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), address);
  const bool whole = error == std::errc{} && end == number.data() + number.size();
  if (!whole || address == all_beacons || dot == std::string_view::npos) {
    throw SettingError(
        fmt::format("{}: expected beacon.ADDRESS.GROUP.KEY with an address of 0 … {}", key, all_beacons - 1));
  }
  return {address, rest.substr(dot + 1)};
}

std::string as_toml(const SettingValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *text);
  if (const auto* real = std::get_if<double>(&value)) {
    // TOML requires a point in a float; otherwise it would read as an integer.
    std::string text = settings::to_text(*real);
    if (text.find_first_of(".eni") == std::string::npos) text += ".0";
    return text;
  }
  return settings::to_text(value);
}

std::string item_text(int item) {
  return item == settings::no_item ? std::string() : fmt::format("Item {}. ", item);
}

/// Wraps a sentence into lines of at most 120 bytes that start with "# ".
std::string as_comment(const std::string& sentence) {
  constexpr std::size_t max_columns = 120;
  std::string lines;
  std::string line = "#";
  std::istringstream words(sentence);
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > max_columns) {
      lines += line + '\n';
      line = "#";
    }
    line += ' ' + word;
  }
  return lines + line + '\n';
}

/// Returns the header of a key's group, after `prefix`. The key must exist.
std::string table_header(const std::string& prefix, const std::string& group) {
  return fmt::format("\n[{}{}]\n", prefix, group);
}

/// Writes settings as tables. TOML allows each table only once per file.
std::string tables_of(const std::string& prefix, const Assignments& assignments) {
  std::map<std::string, std::map<std::string, SettingValue>> groups;
  for (const auto& [key, value] : assignments) {
    const auto& row = settings::setting_info(key);
    groups[row.group][row.name] = value;
  }
  std::string text;
  for (const auto& [name, values] : groups) {
    text += table_header(prefix, name);
    for (const auto& [key, value] : values) text += fmt::format("{} = {}\n", key, as_toml(value));
  }
  return text;
}

std::string tables_of(const std::map<BeaconAddress, Assignments>& overrides) {
  std::string text;
  for (const auto& [address, own] : overrides) text += tables_of(fmt::format("beacon.{}.", address), own);
  return text;
}

}  // namespace

FusionConfig FusionConfig::load(const std::filesystem::path& file, const std::filesystem::path& without) {
  FusionConfig config;
  config.unused_ = toml::unread_drop_ins(file);
  for (const std::filesystem::path& each : files_of(file, without)) config.add(each);
  return config;
}

void FusionConfig::add(const std::filesystem::path& file) {
  for (const toml::Leaf& leaf : leaves_of(file)) {
    if (leaf.key.starts_with(program_prefix)) continue;
    const auto at_line = [&](const SettingError& error) {
      return fmt::format("{}:{}: {}", file.string(), leaf.line, error.what());
    };
    try {
      set(leaf.key, value_of(leaf));
    } catch (const settings::RenamedSetting& error) {
      unused_.push_back(at_line(error) + "; this value is not used");
    } catch (const SettingError& error) {
      throw ConfigError(at_line(error));
    }
  }
}

void FusionConfig::assign(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw ConfigError(fmt::format("--set {}: expected GROUP.KEY=VALUE", assignment));
  }
  const std::string_view key = assignment.substr(0, equals);
  const std::string_view text = assignment.substr(equals + 1);
  try {
    const std::string_view setting_key = key.starts_with(beacon_prefix) ? split_beacon(key).second : key;
    set(key, settings::parse_value(setting_key, text));
  } catch (const SettingError& error) {
    throw ConfigError(fmt::format("--set {}: {}", assignment, error.what()));
  }
}

void FusionConfig::set(std::string_view key, const SettingValue& value) {
  if (key.starts_with(beacon_prefix)) {
    const auto [address, setting_key] = split_beacon(key);
    settings::Settings trial;
    settings::set(trial, setting_key, value);
    overrides_[address].insert_or_assign(std::string(setting_key), value);
    return;
  }
  settings::set(settings_, key, value);
  given_.insert_or_assign(std::string(key), value);
}

settings::Settings FusionConfig::for_beacon(BeaconAddress address) const {
  return beacon(address).settings();
}

BeaconSettings FusionConfig::beacon(BeaconAddress address) const {
  BeaconSettings settings(settings_);
  if (const auto found = overrides_.find(address); found != overrides_.end()) {
    settings.assign_own(found->second);
  }
  return settings;
}

std::vector<BeaconAddress> FusionConfig::beacons() const {
  std::vector<BeaconAddress> addresses;
  for (const auto& entry : overrides_) addresses.push_back(entry.first);
  return addresses;
}

void FusionConfig::check() const {
  const auto throw_on = [](const std::string& fault, const std::string& whose) {
    if (!fault.empty()) throw ConfigError(whose + fault);
  };
  throw_on(fault_of(settings_), "");
  for (const BeaconAddress address : beacons()) {
    throw_on(fault_of(for_beacon(address)), fmt::format("beacon {}: ", address));
  }
}

std::vector<std::string> FusionConfig::warnings(OtherEngine other_engine) const {
  std::map<BeaconAddress, settings::Settings> of_beacons;
  for (const auto& entry : overrides_) of_beacons.emplace(entry.first, for_beacon(entry.first));
  std::vector<std::string> texts = unused_;
  for (std::string& text : warnings_for_all(settings_, given_, of_beacons, other_engine)) {
    texts.push_back(std::move(text));
  }
  for (const auto& [address, own] : overrides_) {
    const auto more =
        warnings_for(of_beacons.at(address), own, fmt::format("beacon.{}.", address), other_engine);
    texts.insert(texts.end(), more.begin(), more.end());
  }
  return texts;
}

std::string FusionConfig::to_toml() const {
  std::string text =
      "# Settings of sonopose-fusion. Every value below is what is used; delete what you do not change.\n"
      "# Items 2, 3 and 4 are commented out if the preset (item 1) sets them.\n"
      "# Settings of a single beacon: [beacon.7.heading] and so on.\n";
  const bool has_preset = settings_.preset.imu_weight != settings::ImuWeight::user;
  const settings::Settings used = settings::resolved(settings_);
  std::string group;
  for (const auto& row : settings::setting_table()) {
    if (row.group != group) text += table_header("", row.group);
    group = row.group;
    text += as_comment(fmt::format("{}{} ({})", item_text(row.item), row.sentence, row.allowed()));
    const bool by_preset = has_preset && !given_.contains(row.key) && is_preset_key(row.key);
    const SettingValue value = settings::get(by_preset ? used : settings_, row.key);
    text += fmt::format("{}{} = {}\n", by_preset ? "# " : "", row.name, as_toml(value));
  }
  return text + tables_of(overrides_);
}

std::string FusionConfig::given_toml() const {
  return tables_of("", given_) + tables_of(overrides_);
}

FusionConfig FusionConfig::changes_from(const FusionConfig& base) const {
  FusionConfig changes;
  for (const auto& row : settings::setting_table()) {
    const SettingValue value = settings::get(settings_, row.key);
    if (value != settings::get(base.settings_, row.key)) changes.set(row.key, value);
  }
  for (const auto& [address, own] : overrides_) {
    const auto known = base.overrides_.find(address);
    for (const auto& [key, value] : own) {
      const bool is_known = known != base.overrides_.end() && known->second.contains(key) &&
                            known->second.find(key)->second == value;
      if (!is_known) changes.overrides_[address].insert_or_assign(key, value);
    }
  }
  return changes;
}

std::size_t FusionConfig::given() const {
  std::size_t count = given_.size();
  for (const auto& entry : overrides_) count += entry.second.size();
  return count;
}

}  // namespace sonopose::config
