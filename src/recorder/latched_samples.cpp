#include "recorder/latched_samples.hpp"

#include "recorder/chunk_messages.hpp"
#include "recorder/instance_end.hpp"

#include <span>

namespace sonopose::recorder {
namespace {

std::string_view text_of(std::span<const std::byte> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};  // NOLINT(*-reinterpret-cast): text
}

}  // namespace

void LatchedSamples::on(const mcap::Chunk& chunk) {
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    if (entry.channel_id == ends_channel_id_) {
      forget(text_of(message_at(chunk, entry).data));
    } else if (topics_.contains(entry.channel_id)) {
      const mcap::Message message = message_at(chunk, entry);
      const auto address = dds::topics::beacon_of(message.data);
      if (!address) continue;
      samples_[key_of(entry.channel_id, *address)] = {
          message.sequence, message.publish_time_ns, {message.data.begin(), message.data.end()}};
    }
  }
}

void LatchedSamples::forget(std::string_view instance_end) {
  const InstanceEnd end = instance_end_of(instance_end);
  const auto address = dds::topics::beacon_of(end.key_cdr);
  for (const auto& [channel_id, topic] : topics_) {
    if (topic == end.topic && address) samples_.erase(key_of(channel_id, *address));
  }
}

mcap::Chunk LatchedSamples::chunk_at(std::uint64_t log_time_ns) const {
  mcap::Chunk chunk;
  for (const auto& [key, sample] : samples_) {
    chunk.add({.channel_id = key.first,
               .sequence = sample.sequence,
               .log_time_ns = log_time_ns,
               .publish_time_ns = sample.publish_time_ns,
               .data = sample.data});
  }
  return chunk;
}

}  // namespace sonopose::recorder
