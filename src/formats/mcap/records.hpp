#pragma once
/// \file
/// The records of an MCAP file as values, named as in the specification: https://mcap.dev/spec.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>

namespace sonopose::mcap {

/// First and last bytes of a file.
inline constexpr std::array<unsigned char, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

/// Size of the prefix of each record: opcode and length of the content.
inline constexpr std::size_t record_prefix_bytes = 1 + 8;

/// Size of the fields of a message before its data.
inline constexpr std::size_t message_field_bytes = 2 + 4 + 8 + 8;

inline constexpr std::size_t footer_bytes = record_prefix_bytes + 8 + 8 + 4;

using TextMap = std::map<std::string, std::string>;

/// Schema id of a channel without schema. Readers ignore a Schema of this id.
inline constexpr std::uint16_t no_schema = 0;

struct Schema {
  std::uint16_t id = no_schema;
  std::string name;
  std::string encoding;
  std::string data;

  bool operator==(const Schema&) const = default;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = no_schema;
  std::string topic;
  std::string message_encoding;
  TextMap metadata;

  bool operator==(const Channel&) const = default;
};

/// A message. Times are nanoseconds since the Unix epoch.
struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;      ///< time of recording
  std::uint64_t publish_time_ns = 0;  ///< time of publication; the log time if unknown
  std::span<const std::byte> data;    ///< data, not owned
};

struct Metadata {
  std::string name;
  TextMap values;

  bool operator==(const Metadata&) const = default;
};

/// The place of a record.
struct Extent {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  ///< length including opcode and length field
  std::size_t file = 0;      ///< number of the file, in a recording of several
};

/// First and last log time of messages. Without messages, both are 0 in a file.
struct TimeSpan {
  std::uint64_t start_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t end_ns = 0;

  [[nodiscard]] bool is_empty() const { return start_ns > end_ns; }
  /// Returns the log time that many seconds after the first message, clamped to the range of log times.
  [[nodiscard]] std::uint64_t after_start(double seconds) const {
    constexpr auto max_ns = std::numeric_limits<std::uint64_t>::max();
    if (seconds <= 0) return start_ns;
    const double after_ns = seconds * 1e9;
    if (after_ns >= static_cast<double>(max_ns - start_ns)) return max_ns;
    return start_ns + static_cast<std::uint64_t>(after_ns);
  }
  void include(std::uint64_t time_ns) {
    if (time_ns < start_ns) start_ns = time_ns;
    if (time_ns > end_ns) end_ns = time_ns;
  }
  void include(const TimeSpan& other) {
    if (other.is_empty()) return;
    include(other.start_ns);
    include(other.end_ns);
  }
  bool operator==(const TimeSpan&) const = default;
};

/// Counts of the records in a file.
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  TimeSpan log_times;
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;

  bool operator==(const Statistics&) const = default;
};

enum class Compression { none, lz4, zstd };

}  // namespace sonopose::mcap
