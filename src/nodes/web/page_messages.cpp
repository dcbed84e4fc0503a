#include "web/page_messages.hpp"

#include "observation/status_words.hpp"
#include "observation/stream_state.hpp"
#include "web/live/event_json.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>

namespace sonopose::web {
namespace {

/// Serialises text from the bus, which need not be UTF-8.
std::string dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json address_json(BeaconAddress address) {
  return address == all_beacons ? nlohmann::json("all") : nlohmann::json(address);
}

nlohmann::json value_json(const settings::SettingValue& value) {
  return std::visit([](const auto& each) { return nlohmann::json(each); }, value);
}

const char* type_of(const settings::SettingInfo& info) {
  if (!info.choices.empty()) return "choice";
  constexpr std::array names{"bool", "int", "double", "choice"};
  return names[info.initial.index()];
}

}  // namespace

std::string text_of(const Hello& hello) {
  return dump({{"op", "hello"},
               {"version", hello.version},
               {"mode", hello.is_recording ? "recording" : "live"},
               {"allow_changes", hello.allows_changes},
               {"domain", hello.domain_id ? nlohmann::json(*hello.domain_id) : nlohmann::json()},
               {"title", hello.title}});
}

std::string text_of(const Reply& reply) {
  return dump({{"op", "reply"},
               {"id", reply.id},
               {"accepted", reply.accepted},
               {"reason", reply.reason},
               {"details", reply.details},
               {"from_event", reply.from_sequence}});
}

std::string event_text(TimeNs time_ns, std::string_view level, std::string_view text) {
  nlohmann::json event = live::event_json(time_ns, level, text);
  event["op"] = "event";
  return dump(event);
}

std::string event_text(const LogLine& line, std::uint64_t missing) {
  nlohmann::json event = live::event_json(line, missing);
  event["op"] = "event";
  return dump(event);
}

std::string settings_text(const EffectiveSettings& settings) {
  nlohmann::json values = nlohmann::json::object();
  for (const SettingAssignment& each : settings.values) values[each.key] = each.value;
  return dump({{"op", "settings"},
               {"address", address_json(settings.address)},
               {"values", std::move(values)},
               {"from_event", settings.from_sequence}});
}

std::string stationary_text(const std::map<BeaconAddress, Vector3d>& positions_world_m) {
  nlohmann::json beacons = nlohmann::json::array();
  for (const auto& [address, position_m] : positions_world_m) {
    beacons.push_back({{"a", address}, {"x", position_m.x()}, {"y", position_m.y()}, {"z", position_m.z()}});
  }
  return dump({{"op", "stationary"}, {"beacons", std::move(beacons)}});
}

std::string gone_text(BeaconAddress address) {
  return fmt::format(R"({{"op":"gone","a":{}}})", address);
}

std::string dropped_text(std::uint64_t frames) {
  return fmt::format(R"({{"op":"dropped","frames":{}}})", frames);
}

std::string findings_text(std::string_view report) {
  return fmt::format(R"({{"op":"findings","running":false,"share":1,{})", report.substr(1));
}

std::string examining_text(double share) {
  return fmt::format(R"({{"op":"findings","running":true,"share":{:.2f},"findings":[]}})", share);
}

std::string status_text(std::string_view views) {
  return fmt::format(R"({{"op":"status",{})", views.substr(1));
}

std::string status_table_json() {
  nlohmann::json table = nlohmann::json::array();
  for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
    const std::string word = observation::status_words(bit);
    if (word == observation::status_words(0)) continue;  // the bit has no meaning
    table.push_back({{"bit", bit},
                     {"word", word},
                     {"severity", observation::severity_of_status(bit)},
                     {"hidden_by", observation::causes_of(bit)}});
  }
  return dump(table);
}

std::string settings_table_json() {
  nlohmann::json table = nlohmann::json::array();
  for (const settings::SettingInfo& info : settings::setting_table()) {
    const std::string type = type_of(info);
    nlohmann::json row{
        {"key", info.key},
        {"item", info.item == settings::no_item ? nlohmann::json() : nlohmann::json(info.item)},
        {"group", info.group},
        {"type", type},
        {"unit", info.unit},
        {"default", value_json(info.initial)},
        {"allowed", info.allowed()},
        {"sentence", info.sentence}};
    if (type == "int" || type == "double") {
      row["min"] = value_json(info.minimum);
      row["max"] = value_json(info.maximum);
    }
    for (const std::string_view choice : info.choices) row["choices"].push_back(choice);
    table.push_back(std::move(row));
  }
  return dump(table);
}

}  // namespace sonopose::web
