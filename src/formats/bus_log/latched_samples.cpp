#include "bus_log/latched_samples.hpp"

#include "bus_log/instance_end.hpp"
#include "mcap/chunk_messages.hpp"

#include <span>
#include <utility>

namespace sonopose::bus_log {
namespace {

std::string_view text_in(std::span<const std::byte> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};  // NOLINT(*-reinterpret-cast): text
}

}  // namespace

void LatchedSamples::on(const mcap::Chunk& chunk) {
  for (const mcap::Chunk::Entry& entry : chunk.entries()) on(message_at(chunk, entry));
}

void LatchedSamples::on(const mcap::Message& message) {
  const auto sample = [&message] {
    return Sample{message.sequence, message.publish_time_ns, {message.data.begin(), message.data.end()}};
  };
  if (message.channel_id == ends_channel_id_) {
    forget(text_in(message.data));
  } else if (const auto topic = topics_.find(message.channel_id); topic != topics_.end()) {
    samples_[key_of(message.channel_id, *topic->second, message.data)] = sample();
  } else if (const auto plain = plain_.find(message.channel_id); plain != plain_.end()) {
    keep(plain->second, sample());
  }
}

void LatchedSamples::keep(std::vector<Sample>& samples, Sample sample) {
  std::erase_if(samples, [&](const Sample& known) { return known.data == sample.data; });
  if (samples.size() == max_plain) samples.erase(samples.begin());
  samples.push_back(std::move(sample));
}

LatchedSamples::Key LatchedSamples::key_of(std::uint16_t channel_id,
                                           const dds::topics::SerializedTopic& topic,
                                           std::span<const std::byte> sample) {
  const BeaconAddress address = topic.has_beacon ? dds::topics::beacon_of(sample).value_or(0) : 0;
  return {channel_id, static_cast<BeaconAddress>(address - all_beacons), topic.key_fields(sample)};
}

void LatchedSamples::forget(std::string_view instance_end) {
  const InstanceEnd end = instance_end_of(instance_end);
  for (const auto& [channel_id, topic] : topics_) {
    if (topic->name == end.topic) samples_.erase(key_of(channel_id, *topic, end.key_cdr));
  }
}

mcap::Chunk LatchedSamples::chunk_at(std::uint64_t log_time_ns) const {
  mcap::Chunk chunk;
  const auto add = [&](std::uint16_t channel_id, const Sample& sample) {
    chunk.add({.channel_id = channel_id,
               .sequence = sample.sequence,
               .log_time_ns = log_time_ns,
               .publish_time_ns = sample.publish_time_ns,
               .data = sample.data});
  };
  for (const auto& [key, sample] : samples_) add(std::get<0>(key), sample);
  for (const auto& [channel_id, samples] : plain_) {
    for (const Sample& sample : samples) add(channel_id, sample);
  }
  return chunk;
}

}  // namespace sonopose::bus_log
