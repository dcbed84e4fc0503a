#include "web/foxglove/protocol.hpp"

#include <nlohmann/json.hpp>

#include <limits>
#include <type_traits>

namespace sonopose::web::foxglove {
namespace {

enum class BinaryOp : std::uint8_t { message_data = 1, time = 2 };

template <class Integer>
void append_little_endian(std::string& text, Integer value) {
  auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    text += static_cast<char>(bits & 0xFFU);
    bits >>= 8U;
  }
}

/// An id: an integer of 32 bits.
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

std::string server_info(const std::string& name, const std::string& session_id) {
  return nlohmann::json{{"op", "serverInfo"},
                        {"name", name},
                        {"capabilities", {"time"}},
                        {"metadata", nlohmann::json::object()},
                        {"sessionId", session_id}}
      .dump();
}

std::string advertise(std::span<const Channel> channels) {
  nlohmann::json json{{"op", "advertise"}, {"channels", nlohmann::json::array()}};
  for (const Channel& channel : channels) {
    json["channels"].push_back({{"id", channel.id},
                                {"topic", channel.topic},
                                {"encoding", channel.encoding},
                                {"schemaName", channel.schema_name},
                                {"schema", channel.schema},
                                {"schemaEncoding", channel.schema_encoding}});
  }
  return json.dump();
}

std::string status(StatusLevel level, const std::string& message) {
  return nlohmann::json{{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string time(TimeNs time_ns) {
  std::string text(1, static_cast<char>(BinaryOp::time));
  append_little_endian(text, time_ns);
  return text;
}

std::string message_data(SubscriptionId subscription, TimeNs received_ns,
                         std::span<const std::byte> payload) {
  std::string text;
  text.reserve(1 + sizeof subscription + sizeof received_ns + payload.size());
  text += static_cast<char>(BinaryOp::message_data);
  append_little_endian(text, subscription);
  append_little_endian(text, received_ns);
  text.append(reinterpret_cast<const char*>(payload.data()), payload.size());  // NOLINT(*-reinterpret-cast)
  return text;
}

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
