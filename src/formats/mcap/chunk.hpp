#pragma once
/// \file
/// Messages that are written to a file together.

#include "mcap/records.hpp"

#include <vector>

namespace sonopose::mcap {

/// Collects messages in their final form, without a file or writer. One thread can fill a chunk while another
/// writes the previous one, and a chunk can wait in memory until it is needed.
class Chunk {
public:
  /// The place of a message in `records`.
  struct Entry {
    std::uint16_t channel_id = 0;
    std::uint64_t log_time_ns = 0;
    std::uint64_t offset = 0;
  };

  /// Allocates memory for that many bytes of records and that many messages. It grows when needed.
  explicit Chunk(std::size_t byte_count = 0, std::size_t message_count = 0);

  /// Appends a copy of the message. `head` precedes the message's data, for data in two pieces.
  void add(const Message& message, std::span<const std::byte> head = {});

  /// Returns the bytes that a message adds to `records`.
  static constexpr std::size_t bytes_of(std::size_t data_bytes) {
    return record_prefix_bytes + message_field_bytes + data_bytes;
  }

  /// Removes all messages and keeps the memory.
  void clear();

  [[nodiscard]] bool is_empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t message_count() const { return entries_.size(); }
  [[nodiscard]] const TimeSpan& log_times() const { return log_times_; }
  /// The uncompressed records of the messages.
  [[nodiscard]] std::span<const std::byte> records() const { return records_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

private:
  std::vector<std::byte> records_;
  std::vector<Entry> entries_;
  TimeSpan log_times_;
};

}  // namespace sonopose::mcap
