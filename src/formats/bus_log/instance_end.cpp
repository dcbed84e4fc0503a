#include "bus_log/instance_end.hpp"

#include <sonopose/text/hexadecimal.hpp>

#include <nlohmann/json.hpp>

#include <charconv>
#include <stdexcept>

namespace sonopose::bus_log {
namespace {

constexpr std::string_view disposed = "disposed";
constexpr std::string_view no_writers = "no_writers";

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size() / 2);
  const char* at = text.data();
  for (std::byte& byte : bytes) {
    unsigned value = 0;
    if (std::from_chars(at, at + 2, value, 16).ptr != at + 2) throw std::invalid_argument("key_cdr: " + text);
    byte = static_cast<std::byte>(value);
    at += 2;
  }
  if (text.size() % 2 != 0) throw std::invalid_argument("key_cdr: " + text);
  return bytes;
}

}  // namespace

const std::string_view instance_end_schema = R"({
  "title": "sonopose.InstanceEnd",
  "type": "object",
  "properties": {
    "topic": {"type": "string"},
    "kind": {"type": "string", "enum": ["disposed", "no_writers"]},
    "key": {"type": "object"},
    "key_cdr": {"type": "string"},
    "source_time_ns": {"type": "integer"}
  },
  "required": ["topic", "kind", "key_cdr", "source_time_ns"]
})";

std::string json_of(const InstanceEnd& end) {
  nlohmann::ordered_json json{{"topic", end.topic}, {"kind", end.disposed ? disposed : no_writers}};
  if (const auto* const topic = dds::topics::find_topic(end.topic); topic != nullptr) {
    nlohmann::ordered_json key = nlohmann::ordered_json::object();
    for (const auto& field : topic->key_fields(end.key_cdr)) {
      std::visit([&](const auto& value) { key[field.name] = value; }, field.value);
    }
    json["key"] = std::move(key);
  }
  json["key_cdr"] = text::hexadecimal(end.key_cdr);
  json["source_time_ns"] = end.source_time_ns;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

InstanceEnd instance_end_of(std::string_view text) {
  try {
    const nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
    const std::string kind = json.at("kind");
    if (kind != disposed && kind != no_writers) throw std::invalid_argument("kind: " + kind);
    if (!json.at("source_time_ns").is_number_integer())
      throw std::invalid_argument("source_time_ns: is no integer");
    return {.topic = json.at("topic"),
            .disposed = kind == disposed,
            .key_cdr = bytes_of(json.at("key_cdr")),
            .source_time_ns = json.at("source_time_ns")};
  } catch (const nlohmann::ordered_json::exception& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace sonopose::bus_log
