#pragma once
/// \file
/// The latest samples of the topics whose late readers receive them: every file of a recording begins with
/// them.

#include "mcap/chunk.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace sonopose::recorder {

class LatchedSamples {
public:
  /// The native topics of such channels; and the channel of the ends of instances.
  LatchedSamples(std::map<std::uint16_t, const dds::topics::SerializedTopic*> topics,
                 std::uint16_t ends_channel_id)
      : topics_(std::move(topics)), ends_channel_id_(ends_channel_id) {}

  /// A channel without keys and ends, such as one of ROS 2: its latest messages that differ are kept, since
  /// each of several programs may publish its own.
  void add_plain(std::uint16_t channel_id) { plain_.try_emplace(channel_id); }

  /// Remembers what a chunk has of them, and forgets the instances that ended.
  void on(const mcap::Chunk& chunk);

  /// All of them, logged at this time.
  [[nodiscard]] mcap::Chunk chunk_at(std::uint64_t log_time_ns) const;

private:
  struct Sample {
    std::uint32_t sequence = 0;
    std::uint64_t publish_time_ns = 0;
    std::vector<std::byte> data;
  };

  using Fields = std::vector<dds::topics::KeyField>;
  using Key = std::tuple<std::uint16_t, BeaconAddress, Fields>;

  /// What is of all beacons comes first. `sample`: or only its key.
  static Key key_of(std::uint16_t channel_id, const dds::topics::SerializedTopic& topic,
                    std::span<const std::byte> sample);
  void forget(std::string_view instance_end);
  static constexpr std::size_t most_plain = 64;  ///< messages of such a channel
  static void keep(std::vector<Sample>& samples, Sample sample);

  std::map<std::uint16_t, const dds::topics::SerializedTopic*> topics_;
  std::uint16_t ends_channel_id_;
  std::map<Key, Sample> samples_;
  std::map<std::uint16_t, std::vector<Sample>> plain_;  ///< by channel, the oldest first
};

}  // namespace sonopose::recorder
