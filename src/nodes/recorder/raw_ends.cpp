#include "recorder/raw_ends.hpp"

#include "mcap/chunk_messages.hpp"

#include <span>

namespace sonopose::recorder {
namespace {

bus_log::InstanceEnd end_of(const mcap::Message& raw, const TopicName& topic_name) {
  const auto low = std::to_integer<unsigned>(raw.data[0]);
  const auto high = std::to_integer<unsigned>(raw.data[1]);
  const auto key = raw.data.subspan(RawEndHead().size());
  return {.topic = topic_name(static_cast<std::uint16_t>(low | high << 8U)),
          .disposed = raw.data[2] != std::byte{0},
          .key_cdr = {key.begin(), key.end()},
          .source_time_ns = static_cast<std::int64_t>(raw.publish_time_ns)};
}

}  // namespace

RawEndHead raw_end_head(std::uint16_t channel_id, bool is_disposed) {
  return {static_cast<std::byte>(channel_id), static_cast<std::byte>(channel_id >> 8U),
          static_cast<std::byte>(is_disposed ? 1 : 0)};
}

mcap::Chunk with_ends_as_text(const mcap::Chunk& chunk, std::uint16_t ends_channel_id,
                              const TopicName& topic_name, std::uint32_t& sequence) {
  mcap::Chunk text_chunk(chunk.records().size(), chunk.message_count());
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    mcap::Message message = message_at(chunk, entry);
    std::string text;
    if (entry.channel_id == ends_channel_id) {
      text = bus_log::json_of(end_of(message, topic_name));
      message.data = std::as_bytes(std::span(text));
      message.sequence = ++sequence;
    }
    text_chunk.add(message);
  }
  return text_chunk;
}

}  // namespace sonopose::recorder
