#pragma once
/// \file
/// Messages in a chunk that is not written yet.

#include "mcap/chunk.hpp"
#include "mcap/decoder.hpp"

namespace sonopose::recorder {

/// The message at an entry of the chunk, which must outlive it.
inline mcap::Message message_at(const mcap::Chunk& chunk, const mcap::Chunk::Entry& entry) {
  const std::byte* const record = chunk.records().data() + entry.offset;
  const std::byte* const fields = record + mcap::record_prefix_bytes;
  const auto length = mcap::load<std::uint64_t>(record + 1);
  return {.channel_id = entry.channel_id,
          .sequence = mcap::load<std::uint32_t>(fields + 2),
          .log_time_ns = entry.log_time_ns,
          .publish_time_ns = mcap::load<std::uint64_t>(fields + 14),
          .data = {fields + mcap::message_field_bytes, length - mcap::message_field_bytes}};
}

}  // namespace sonopose::recorder
