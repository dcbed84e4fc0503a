#include "settings_client/settings_report.hpp"

#include "config/beacon_settings.hpp"
#include "config/fusion_config.hpp"
#include "files/error.hpp"
#include "files/replacement.hpp"
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace sonopose::settings_client {
namespace {

/// A number or a boolean if the text is one, else a string.
nlohmann::json json_value(const std::string& text) {
  auto value = nlohmann::json::parse(text, nullptr, false);
  return value.is_number() || value.is_boolean() ? value : nlohmann::json(text);
}

/// A value of JSON on one line. Texts of another process need not be UTF-8.
std::string text_json(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A literal that is valid in both TOML and JSON.
std::string literal(const std::string& text) {
  return json_value(text).is_string() ? text_json(text) : text;
}

const std::string* value_of(const EffectiveSettings& settings, const std::string& key) {
  const auto found = std::find_if(settings.values.begin(), settings.values.end(),
                                  [&key](const auto& entry) { return entry.key == key; });
  return found == settings.values.end() ? nullptr : &found->value;
}

/// Values of one beacon under the key `name`.
nlohmann::json object_of(const EffectiveSettings& settings, const char* name) {
  nlohmann::json values = nlohmann::json::object();
  for (const auto& [key, value] : settings.values) values[key] = json_value(value);
  const bool all = settings.address == all_beacons;
  return {{"beacon", all ? nlohmann::json("all") : nlohmann::json(settings.address)},
          {"from_event", settings.from_sequence},
          {"time_ns", settings.time_ns},
          {name, std::move(values)}};
}

/// True if `name` is the key itself or a group that contains it.
bool matches(const std::string& key, const std::string& name) {
  return key == name || key.starts_with(name + ".");
}

/// Header of the values of one beacon, or of all_beacons.
std::string toml_header(const EffectiveSettings& settings) {
  if (settings.address != all_beacons) {
    return fmt::format("[beacon.{}]  # from event {}\n", settings.address, settings.from_sequence);
  }
  const std::string from =
      settings.from_sequence == 0 ? "" : fmt::format(", from event {}", settings.from_sequence);
  return fmt::format("# Defaults of all beacons{}\n", from);
}

/// Returns the settings of a fusion as a configuration.
config::FusionConfig config_of(const std::vector<EffectiveSettings>& changed) {
  config::FusionConfig config;
  for (const EffectiveSettings& settings : changed) {
    const std::string prefix =
        settings.address == all_beacons ? "" : fmt::format("beacon.{}.", settings.address);
    for (const auto& [key, value] : settings.values)
      config.assign(fmt::format("{}{}={}", prefix, key, value));
  }
  return config;
}

}  // namespace

SettingAssignment parse_assignment(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw std::invalid_argument(fmt::format("{}: expected KEY=VALUE", text));
  }
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

void check_names(const std::vector<std::string>& names) {
  const auto& table = settings::setting_table();
  for (const std::string& name : names) {
    if (std::none_of(table.begin(), table.end(), [&](const auto& row) { return matches(row.key, name); })) {
      settings::setting_info(name);  // throws
    }
  }
}

EffectiveSettings selected(EffectiveSettings settings, const std::vector<std::string>& names) {
  if (names.empty()) return settings;
  for (const std::string& name : names) {
    if (std::none_of(settings.values.begin(), settings.values.end(),
                     [&](const auto& entry) { return matches(entry.key, name); })) {
      throw std::invalid_argument(fmt::format("there is no setting and no group '{}'", name));
    }
  }
  std::erase_if(settings.values, [&](const auto& entry) {
    return std::none_of(names.begin(), names.end(),
                        [&](const std::string& name) { return matches(entry.key, name); });
  });
  return settings;
}

std::string toml_of(const std::vector<EffectiveSettings>& settings, const std::vector<std::string>& names) {
  std::string text;
  for (const EffectiveSettings& beacon : settings) {
    const std::string* preset = value_of(beacon, "documented.imu_weight");
    const bool has_preset = preset != nullptr && *preset != "user";
    text += toml_header(beacon);
    for (const auto& [key, value] : selected(beacon, names).values) {
      const bool by_preset = has_preset && config::is_preset_key(key);
      text += fmt::format("{}{} = {}\n", by_preset ? "# " : "", text::escaped(key), literal(value));
    }
  }
  return text;
}

std::string save(const std::vector<EffectiveSettings>& changed, const std::filesystem::path& file) {
  const config::FusionConfig config = config_of(changed);
  files::write_whole(file,
                     "# Saved by sonopose-settings: what differs from the defaults, and each beacon's own. "
                     "For --config of the fusion.\n" +
                         config.given_toml());
  return fmt::format(
      "{}: {}", file.string(),
      text::count_text(config.given(), "setting that differs from the defaults or is a beacon's own",
                       "settings that differ from the defaults or are a beacon's own"));
}

std::string save_drop_in(const std::vector<EffectiveSettings>& changed, const std::filesystem::path& base) {
  std::error_code absent;
  if (!std::filesystem::exists(base, absent)) {
    throw files::IoError(
        fmt::format("{}: no such file; `save FILE` writes a new file, --config names the file of the fusion",
                    base.string()));
  }
  const std::filesystem::path file = base.string() + ".d/90-saved.toml";
  const auto changes = config_of(changed).changes_from(config::FusionConfig::load(base, file));
  std::error_code error;
  std::filesystem::create_directory(file.parent_path(), error);
  if (error) throw files::IoError(fmt::format("{}: {}", file.parent_path().string(), error.message()));
  files::write_whole(file, fmt::format("# Saved by sonopose-settings: what differs from {} and its other "
                                       "drop-ins.\n{}",
                                       base.string(), changes.given_toml()));
  return fmt::format("{}: {} from {}", file.string(),
                     text::count_text(changes.given(), "setting that differs", "settings that differ"),
                     base.string());
}

std::string json_of(const std::vector<EffectiveSettings>& settings) {
  nlohmann::json list = nlohmann::json::array();
  for (const EffectiveSettings& beacon : settings) list.push_back(object_of(beacon, "settings"));
  return text_json(list) + "\n";
}

std::string SettingsObserver::on(const EffectiveSettings& settings) {
  const auto [known, first] = latest_.try_emplace(settings.address, settings);
  if (first) return {};
  const EffectiveSettings before = std::exchange(known->second, settings);
  EffectiveSettings changed = settings;
  std::erase_if(changed.values, [&before](const SettingAssignment& entry) {
    const std::string* old = value_of(before, entry.key);
    return old != nullptr && *old == entry.value;
  });
  if (changed.values.empty()) return {};
  if (json_) return text_json(object_of(changed, "changed")) + "\n";
  const bool all = settings.address == all_beacons;
  const std::string where = all ? "" : fmt::format("beacon.{}.", settings.address);
  const std::string from =
      settings.from_sequence == 0 ? "" : fmt::format(", from event {}", settings.from_sequence);
  std::string text;
  for (const auto& [key, value] : changed.values) {
    const std::string* old = value_of(before, key);
    text += fmt::format("{}{} = {}  # was {}{}\n", where, text::escaped(key), literal(value),
                        old == nullptr ? "unset" : literal(*old), from);
  }
  return text;
}

std::string effective_time_text(const SettingsReply& reply) {
  const std::uint64_t from = reply.from_sequence;
  if (reply.address != all_beacons) {
    return from == 0 ? fmt::format("from the first event of beacon {}, which has not been received yet",
                                   reply.address)
                     : fmt::format("from event {} of beacon {}", from, reply.address);
  }
  const std::string when =
      changes_no_known_beacon(reply) ? "only for beacons that appear later"
      : from == 0
          ? "from the next event of each beacon"
          : fmt::format("from event {} of each beacon, or from its next event if that is later", from);
  return reply.details.empty() ? when : fmt::format("{} ({})", when, text::escaped(reply.details));
}

bool changes_no_known_beacon(const SettingsReply& reply) {
  return reply.accepted && reply.details.starts_with("unchanged");
}

}  // namespace sonopose::settings_client
