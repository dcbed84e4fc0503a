#pragma once
/// \file
/// The latest samples of topics that send them to late readers. Every file of a recording starts with them,
/// and so does a part of a recording.

#include "mcap/chunk.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace sonopose::bus_log {

/// Memory for the latched samples of any topics.
class LatchedSamples {
public:
  /// `topics`: native topics of latched channels; `ends_channel_id`: channel of the ends of instances, if
  /// there is one.
  LatchedSamples(std::map<std::uint16_t, const dds::topics::SerializedTopic*> topics,
                 std::optional<std::uint16_t> ends_channel_id)
      : topics_(std::move(topics)), ends_channel_id_(ends_channel_id) {}

  /// Adds a channel without keys and ends, such as one of ROS 2. Keeps its latest differing messages, since
  /// each of several programs may publish its own.
  void add_plain(std::uint16_t channel_id) { plain_.try_emplace(channel_id); }

  /// Remembers the latched samples of a chunk, and forgets instances that ended.
  void on(const mcap::Chunk& chunk);
  void on(const mcap::Message& message);

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

  /// Key that sorts samples of all beacons first. `sample`: a sample or only its key.
  static Key key_of(std::uint16_t channel_id, const dds::topics::SerializedTopic& topic,
                    std::span<const std::byte> sample);
  void forget(std::string_view instance_end);
  static constexpr std::size_t max_plain = 64;  ///< most messages of such a channel
  static void keep(std::vector<Sample>& samples, Sample sample);

  std::map<std::uint16_t, const dds::topics::SerializedTopic*> topics_;
  std::optional<std::uint16_t> ends_channel_id_;
  std::map<Key, Sample> samples_;
  std::map<std::uint16_t, std::vector<Sample>> plain_;  ///< by channel, oldest first
};

}  // namespace sonopose::bus_log
