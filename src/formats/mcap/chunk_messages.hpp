#pragma once
/// \file
/// Messages in a chunk that is not written yet.

#include "mcap/chunk.hpp"
#include "mcap/decoder.hpp"

namespace sonopose::mcap {

/// The message at an entry of the chunk, which must outlive it.
inline Message message_at(const Chunk& chunk, const Chunk::Entry& entry) {
  const std::byte* const record = chunk.records().data() + entry.offset;
  const std::byte* const fields = record + record_prefix_bytes;
  const auto length = load<std::uint64_t>(record + 1);
  return {.channel_id = entry.channel_id,
          .sequence = load<std::uint32_t>(fields + 2),
          .log_time_ns = entry.log_time_ns,
          .publish_time_ns = load<std::uint64_t>(fields + 14),
          .data = {fields + message_field_bytes, length - message_field_bytes}};
}

}  // namespace sonopose::mcap
