#pragma once
/// \file
/// Takes the samples of one topic, on the receiving thread.

#include "process/address_set.hpp"
#include "recorder/chunk_queue.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <atomic>
#include <cstdint>

namespace sonopose::recorder {

/// What happened to the samples of a topic, or of all. Each is counted, whatever became of it.
struct TapCounts {
  std::uint64_t received = 0;    ///< of the beacons that are recorded, with the ends of instances
  std::uint64_t lost_queue = 0;  ///< of these: the queue was full
  std::uint64_t lost_bus = 0;    ///< lost before they arrived here, as DDS reports it

  TapCounts& operator+=(const TapCounts& other) {
    received += other.received;
    lost_queue += other.lost_queue;
    lost_bus += other.lost_bus;
    return *this;
  }
  bool operator==(const TapCounts&) const = default;
};

/// Where the messages go: the channel of the topic, and the one of the ends of instances of all topics.
struct TapTarget {
  ChunkQueue& queue;
  std::uint16_t channel_id;
  std::uint16_t ends_channel_id;
  std::atomic<std::uint32_t>& ends_sequence;
};

class TopicTap final : public dds::DataReaderListener<dds::Serialized> {
public:
  /// The references must outlive it. `trigger` may be null.
  TopicTap(const dds::topics::SerializedTopic& topic, const process::AddressSet& beacons,
           const TapTarget& target, TopicTrigger* trigger)
      : topic_(topic), beacons_(beacons), target_(target), trigger_(trigger) {}

  /// From now on samples arrive.
  void open(const dds::DomainParticipant& participant, const dds::qos::Provider& qos) {
    reader_ = topic_.make_reader(participant, qos, this);
  }
  /// No sample arrives any more.
  void close() { reader_.close(); }

  [[nodiscard]] const dds::topics::SerializedTopic& topic() const { return topic_; }
  [[nodiscard]] TapCounts counts() const { return {received_, lost_queue_, lost_bus_}; }
  /// Writers whose QoS does not match the reader's.
  [[nodiscard]] std::uint64_t incompatible() const { return incompatible_; }

  void on_data_available(dds::SerializedReader& reader) noexcept override;
  void on_sample_lost(dds::SerializedReader& reader, const dds::SampleLostStatus& status) noexcept override;
  void on_requested_incompatible_qos(dds::SerializedReader& reader,
                                     const dds::RequestedIncompatibleQosStatus& status) noexcept override;

private:
  [[nodiscard]] bool accepts(std::span<const std::byte> sample) const;
  void on_sample(const dds::SerializedSample& sample, const dds::SampleInfo& info);
  void on_end(const dds::SerializedSample& key, const dds::SampleInfo& info);
  void add(const mcap::Message& message);

  const dds::topics::SerializedTopic& topic_;
  const process::AddressSet& beacons_;
  TapTarget target_;
  TopicTrigger* trigger_;
  std::atomic<std::uint32_t> sequence_ = 0;
  std::atomic<std::uint64_t> received_ = 0;
  std::atomic<std::uint64_t> lost_queue_ = 0;
  std::atomic<std::uint64_t> lost_bus_ = 0;
  std::atomic<std::uint64_t> incompatible_ = 0;
  dds::SerializedReader reader_;  ///< last: its listener is this
};

}  // namespace sonopose::recorder
