#pragma once
/// \file
/// The end of an instance as a message of a file, since MCAP has no form for it (docs/record-and-play.md).

#include <sonopose/dds/topics/serialized_topics.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::bus_log {

struct InstanceEnd {
  std::string topic;
  bool disposed = false;  ///< true: disposed; false: left without writers
  std::vector<std::byte> key_cdr;
  std::int64_t source_time_ns = 0;

  bool operator==(const InstanceEnd&) const = default;
};

/// The channel and schema of these messages.
inline constexpr std::string_view instance_ends_topic = "sonopose/instance_ends";
inline constexpr std::string_view instance_ends_encoding = "json";
inline constexpr std::string_view instance_end_schema_name = "sonopose.InstanceEnd";
inline constexpr std::string_view instance_end_schema_encoding = "jsonschema";
extern const std::string_view instance_end_schema;

/// Writes one line of JSON. For a native topic, it also has the key's fields by name.
std::string json_of(const InstanceEnd& end);

/// Parses such a line. Throws std::invalid_argument with the reason.
InstanceEnd instance_end_of(std::string_view json);

}  // namespace sonopose::bus_log
