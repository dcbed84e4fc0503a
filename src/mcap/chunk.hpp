#pragma once
/// \file
/// Messages that are written to a file together.

#include "mcap/records.hpp"

#include <vector>

namespace sonopose::mcap {

/// Collects messages in the form that they have in a file. It needs no file and no writer: one thread can
/// fill a chunk while another one writes the chunk before, and a chunk can wait in memory until it is known
/// whether it is needed.
class Chunk {
public:
  /// Where a message is in `records`.
  struct Entry {
    std::uint16_t channel_id = 0;
    std::uint64_t log_time_ns = 0;
    std::uint64_t offset = 0;
  };

  /// Memory for that many bytes of records and that many messages; more is allocated where it is needed.
  explicit Chunk(std::size_t byte_count = 0, std::size_t message_count = 0);

  /// Appends a copy of the message. `head` comes before the message's data, for data that are in two pieces.
  void add(const Message& message, std::span<const std::byte> head = {});

  /// The bytes that such a message adds to `records`.
  static constexpr std::size_t bytes_of(std::size_t data_bytes) {
    return record_prefix_bytes + message_field_bytes + data_bytes;
  }

  /// Removes all messages and keeps the memory.
  void clear();

  [[nodiscard]] bool is_empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t message_count() const { return entries_.size(); }
  [[nodiscard]] const TimeSpan& log_times() const { return log_times_; }
  /// The records of the messages, not compressed.
  [[nodiscard]] std::span<const std::byte> records() const { return records_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

private:
  std::vector<std::byte> records_;
  std::vector<Entry> entries_;
  TimeSpan log_times_;
};

}  // namespace sonopose::mcap
