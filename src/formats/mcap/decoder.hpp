#pragma once
/// \file
/// Decodes records from arbitrary bytes.

#include "mcap/encoder.hpp"
#include "mcap/format_error.hpp"
#include "mcap/records.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::mcap {

/// Returns "Chunk", …, or "record" for an opcode that the format does not define.
std::string_view name_of(Opcode opcode);

template <std::unsigned_integral T>
T load(const std::byte* from) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i) {
    value = static_cast<T>(value | (static_cast<T>(from[i]) << (8 * i)));
  }
  return value;
}

/// Limit of memory: an entry takes a hundred bytes, but can have only eight in the file.
inline constexpr std::size_t max_map_entries = 1U << 20U;

/// Bytes that a record takes in memory.
std::uint64_t memory_of(const Schema& schema);
std::uint64_t memory_of(const Channel& channel);
std::uint64_t memory_of(const Metadata& metadata);

/// A common limit for records of several kinds.
class MemoryLimit {
public:
  static constexpr std::uint64_t max_bytes = 256U << 20U;

  /// Throws FormatError, with `what` before the limit, if they would exceed it.
  void reserve(std::uint64_t bytes, std::string_view what, const Place& place);

private:
  std::uint64_t bytes_ = 0;
};

struct Prefix {
  Opcode opcode{};
  std::uint64_t length = 0;  ///< length of the content

  [[nodiscard]] std::uint64_t record_length() const { return record_prefix_bytes + length; }
};

/// Decodes record_prefix_bytes at `bytes`. Throws FormatError unless the record ends within `available` bytes
/// from its start.
Prefix decode_prefix(const std::byte* bytes, std::uint64_t available, const Place& place);

/// The fields of one record from left to right. Each member throws FormatError if the record ends before the
/// field. Only the length of texts is checked.
class Fields {
public:
  Fields(std::span<const std::byte> content, Opcode opcode, const Place& place)
      : rest_{content}, opcode_{opcode}, place_{place} {}

  template <std::unsigned_integral T>
  T number(std::string_view field) {
    return load<T>(take(sizeof(T), field).data());
  }
  std::string text(std::string_view field);
  /// Keeps the first value of a repeated key.
  TextMap map(std::string_view field);
  /// The content of a map or array with a 32-bit length.
  Fields sized(std::string_view field);
  /// Skips first and last log time: writers have stated wrong ones. Messages and their indexes have the right
  /// ones.
  void skip_times();
  std::span<const std::byte> take(std::uint64_t count, std::string_view field);

  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }
  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }
  /// Names a map with a repeated key, which the format discourages but allows.
  [[nodiscard]] std::optional<std::string> repeated_key() const;
  [[noreturn]] void fail(std::string_view field, const std::string& what) const;

private:
  std::span<const std::byte> rest_;
  Opcode opcode_;
  Place place_;
  bool has_repeated_key_ = false;
};

/// A chunk without its records.
struct ChunkFields {
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
};

struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::uint64_t> log_times_ns;  ///< log times of its messages
};

/// An attachment without its data.
struct AttachmentFields {
  std::uint64_t log_time_ns = 0;
  std::uint64_t create_time_ns = 0;
  std::string name;
  std::string media_type;
  std::uint64_t data_size = 0;
  std::uint32_t crc = 0;
  std::size_t crc_at = 0;  ///< place of the checksum in the content; it covers what precedes it
};

struct Footer {
  std::uint64_t summary_start = 0;
  std::uint32_t summary_crc = 0;
};

struct Header {
  std::string profile;
  std::string library;
};

Header decode_header(Fields fields);
Footer decode_footer(Fields fields);
Schema decode_schema(Fields fields);
Channel decode_channel(Fields& fields);  ///< records a repeated key in `fields`
Message decode_message(Fields fields);
ChunkFields decode_chunk(Fields& fields);  ///< leaves what follows the size of the records
Extent decode_chunk_index(Fields fields);
MessageIndex decode_message_index(Fields fields);
Statistics decode_statistics(Fields fields);  ///< without log times
Metadata decode_metadata(Fields& fields);     ///< records a repeated key in `fields`
AttachmentFields decode_attachment(Fields fields);
Extent decode_record_index(Fields fields);  ///< the index of an attachment or of metadata

}  // namespace sonopose::mcap
