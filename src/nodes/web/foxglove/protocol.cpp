#include "web/foxglove/protocol.hpp"

#include <nlohmann/json.hpp>

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

}  // namespace sonopose::web::foxglove
