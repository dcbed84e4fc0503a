#pragma once
/// \file
/// Takes the samples of one topic, on the receiving thread.

#include "process/address_set.hpp"
#include "recorder/chunk_queue.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace sonopose::recorder {

/// What happened to the samples of a topic, or of all. Each is counted, whatever became of it.
struct TapCounts {
  std::uint64_t received = 0;    ///< of the beacons that are recorded, with the ends of instances
  std::uint64_t lost_queue = 0;  ///< of these: the queue was full
  std::uint64_t lost_dds = 0;    ///< arrived and dropped by DDS
  /// Numbers missing among the recorded inputs of the beacons, whatever the reason (EventGaps).
  std::uint64_t events_missing = 0;

  TapCounts& operator+=(const TapCounts& other) {
    received += other.received;
    lost_queue += other.lost_queue;
    lost_dds += other.lost_dds;
    events_missing += other.events_missing;
    return *this;
  }
  bool operator==(const TapCounts&) const = default;
};

/// Which samples are taken.
struct TapTopic {
  std::string name;                         ///< on the bus
  bool has_beacon = false;                  ///< its samples begin with the address of a beacon
  const process::AddressSet* beacons = {};  ///< of these beacons; must outlive the tap if `has_beacon`
  bool is_exclusive = false;                ///< DDS drops the samples of weaker writers: no loss
  TopicTrigger* trigger = nullptr;          ///< looks at the samples; must outlive the tap
};

/// Where the messages go: the channel of the topic, and the one of the ends of instances of all topics, which
/// are not text yet (raw_ends.hpp).
struct TapTarget {
  ChunkQueue& queue;
  std::uint16_t channel_id;
  std::uint16_t ends_channel_id;  ///< 0: ends are not recorded
};

class TopicTap final : public dds::DataReaderListener<dds::Serialized> {
public:
  /// The references in `target` must outlive it.
  TopicTap(TapTopic topic, const TapTarget& target) : topic_(std::move(topic)), target_(target) {}

  /// The reader whose listener this is. Samples may arrive before.
  void open(dds::SerializedReader reader) { reader_ = std::move(reader); }
  /// No sample arrives any more.
  void close() { reader_.close(); }

  [[nodiscard]] const std::string& name() const { return topic_.name; }
  [[nodiscard]] TapCounts counts() const { return {received_, lost_queue_, lost_dds_}; }
  /// Writers whose QoS does not match the reader's.
  [[nodiscard]] std::uint64_t incompatible() const { return incompatible_; }

  void on_data_available(dds::SerializedReader& reader) noexcept override;
  void on_sample_lost(dds::SerializedReader& reader, const dds::SampleLostStatus& status) noexcept override;
  void on_requested_incompatible_qos(dds::SerializedReader& reader,
                                     const dds::RequestedIncompatibleQosStatus& status) noexcept override;

private:
  [[nodiscard]] bool accepts(std::span<const std::byte> sample) const noexcept;
  void on_sample(const dds::SerializedSample& sample, const dds::SampleInfo& info) noexcept;
  void on_end(const dds::SerializedSample& key, const dds::SampleInfo& info) noexcept;
  void add(const mcap::Message& message, std::span<const std::byte> head = {}) noexcept;

  TapTopic topic_;
  TapTarget target_;
  std::atomic<std::uint32_t> sequence_ = 0;
  std::atomic<std::uint64_t> received_ = 0;
  std::atomic<std::uint64_t> lost_queue_ = 0;
  std::atomic<std::uint64_t> lost_dds_ = 0;
  std::atomic<std::uint64_t> incompatible_ = 0;
  dds::SerializedReader reader_;  ///< last: its listener is this
};

}  // namespace sonopose::recorder
