#include "web/page_requests.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>

namespace sonopose::web {
namespace {

constexpr double min_examination_s = 1;
constexpr double max_examination_s = 120;

std::optional<BeaconAddress> address_in(const nlohmann::json& json) {
  const auto found = json.find("address");
  if (found == json.end()) return {};
  if (*found == "all") return all_beacons;
  if (!found->is_number_integer()) return {};
  const auto number = found->get<std::int64_t>();
  return number >= 0 && number < all_beacons ? std::optional(static_cast<BeaconAddress>(number))
                                             : std::nullopt;
}

PageRequest change_from(const nlohmann::json& json, std::uint64_t id) {
  const auto address = address_in(json);
  if (!address) return RefusedRequest{id, "address is neither a beacon's nor \"all\""};
  ChangeRequest request{.id = id, .is_reset = json["op"] == "reset", .settings = {}};
  request.settings.address = *address;
  if (request.is_reset) return request;
  const auto assignments = json.find("assignments");
  if (assignments == json.end() || !assignments->is_object() || assignments->empty()) {
    return RefusedRequest{id, "assignments has no settings"};
  }
  for (const auto& [key, value] : assignments->items()) {
    if (!value.is_string()) return RefusedRequest{id, key + ": the value is not a text"};
    request.settings.assignments.push_back({key, value.get<std::string>()});
  }
  return request;
}

PageRequest examine_from(const nlohmann::json& json, std::uint64_t id) {
  ExamineRequest request;
  if (const auto seconds = json.find("seconds"); seconds != json.end()) {
    if (!seconds->is_number()) return RefusedRequest{id, "seconds is not a number"};
    request.seconds = seconds->get<double>();
  }
  if (request.seconds >= min_examination_s && request.seconds <= max_examination_s) return request;
  return RefusedRequest{id, fmt::format("seconds={} is not between {} and {}", request.seconds,
                                        min_examination_s, max_examination_s)};
}

}  // namespace

PageRequest parse_page_request(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("op") || !json["op"].is_string()) {
    return RefusedRequest{0, "not a JSON object with an op"};
  }
  const auto given_id = json.find("id");
  const std::uint64_t id =
      given_id != json.end() && given_id->is_number_unsigned() ? given_id->get<std::uint64_t>() : 0;
  const auto op = json["op"].get<std::string>();
  if (op == "change" || op == "reset") return change_from(json, id);
  if (op == "examine") return examine_from(json, id);
  return RefusedRequest{id, "the op '" + op.substr(0, 64) + "' is unknown"};
}

}  // namespace sonopose::web
