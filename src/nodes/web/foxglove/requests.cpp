#include "web/foxglove/requests.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <optional>

namespace sonopose::web::foxglove {
namespace {

/// Parses an id: an integer of 32 bits.
std::optional<std::uint32_t> id_of(const nlohmann::json& json) {
  if (!json.is_number_integer()) return {};
  if (json.is_number_unsigned() ? json.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()
                                : json.get<std::int64_t>() < 0) {
    return {};
  }
  return json.get<std::uint32_t>();
}

std::optional<std::uint32_t> id_in(const nlohmann::json& object, const char* key) {
  if (!object.is_object() || !object.contains(key)) return {};
  return id_of(object[key]);
}

Request subscribe_from(const nlohmann::json& json) {
  Subscribe subscribe;
  if (!json.contains("subscriptions") || !json["subscriptions"].is_array()) {
    return Refused{"subscribe: subscriptions is not a list"};
  }
  for (const auto& each : json["subscriptions"]) {
    const auto id = id_in(each, "id");
    const auto channel = id_in(each, "channelId");
    if (!id || !channel) return Refused{"subscribe: a subscription needs id and channelId, 32 bits each"};
    subscribe.items.push_back({*id, *channel});
  }
  return subscribe;
}

Request unsubscribe_from(const nlohmann::json& json) {
  Unsubscribe unsubscribe;
  if (!json.contains("subscriptionIds") || !json["subscriptionIds"].is_array()) {
    return Refused{"unsubscribe: subscriptionIds is not a list"};
  }
  for (const auto& each : json["subscriptionIds"]) {
    const auto id = id_of(each);
    if (!id) return Refused{"unsubscribe: an id has 32 bits"};
    unsubscribe.ids.push_back(*id);
  }
  return unsubscribe;
}

}  // namespace

Request parse_request(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("op") || !json["op"].is_string()) {
    return Refused{"a text message must be a JSON object with an op"};
  }
  const auto op = json["op"].get<std::string>();
  if (op == "subscribe") return subscribe_from(json);
  if (op == "unsubscribe") return unsubscribe_from(json);
  return Refused{"'" + op.substr(0, 64) + "' is not supported: this server has the capability time alone"};
}

}  // namespace sonopose::web::foxglove
