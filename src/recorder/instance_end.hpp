#pragma once
/// \file
/// The end of an instance as a message of a file: MCAP has no form for it (docs/mcap.md).

#include <sonopose/dds/topics/serialized_topics.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::recorder {

struct InstanceEnd {
  std::string topic;
  bool disposed = false;           ///< otherwise it has lost its writers
  std::vector<std::byte> key_cdr;  ///< the serialized key
  std::int64_t source_time_ns = 0;

  bool operator==(const InstanceEnd&) const = default;
};

/// The channel of these messages, and its schema.
inline constexpr std::string_view instance_ends_topic = "sonopose/instance_ends";
inline constexpr std::string_view instance_ends_encoding = "json";
inline constexpr std::string_view instance_end_schema_name = "sonopose.InstanceEnd";
inline constexpr std::string_view instance_end_schema_encoding = "jsonschema";
extern const std::string_view instance_end_schema;

/// One line of JSON. The key also has its fields by name, if the topic is a native one.
std::string json_of(const InstanceEnd& end);

/// Throws std::invalid_argument with the reason if the text is not one.
InstanceEnd instance_end_of(std::string_view json);

}  // namespace sonopose::recorder
