#pragma once
/// \file
/// Takes the samples of one topic, on the receive thread.

#include "presence/address_set.hpp"
#include "recorder/chunk_queue.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace sonopose::recorder {

/// Counts of the samples of one topic, or of all. Each sample is counted, whatever its fate.
struct TapCounts {
  std::uint64_t received = 0;    ///< samples of recorded beacons, including ends of instances
  std::uint64_t lost_queue = 0;  ///< received, but lost because the queue was full
  std::uint64_t lost_dds = 0;    ///< arrived, but dropped by DDS
  /// Missing numbers among the recorded inputs of the beacons, for any reason (EventGaps).
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

/// Selection of samples.
struct TapTopic {
  std::string name;                          ///< name on the bus
  bool has_beacon = false;                   ///< samples start with the address of a beacon
  const presence::AddressSet* beacons = {};  ///< beacons to record; must outlive the tap if `has_beacon`
  bool is_exclusive = false;                 ///< DDS drops the samples of weaker writers, which is no loss
  TopicTrigger* trigger = nullptr;           ///< sees the samples; must outlive the tap
};

/// Destination of messages: the channel of the topic, and the common channel of ends of instances, which are
/// not text yet (raw_ends.hpp).
struct TapTarget {
  ChunkQueue& queue;
  std::uint16_t channel_id;
  std::uint16_t ends_channel_id;  ///< 0: ends are not recorded
};

/// Puts the samples of one topic into the queue, without decoding them.
class TopicTap final : public dds::sub::NoOpDataReaderListener<dds::Serialized> {
public:
  /// The references in `target` must outlive it.
  TopicTap(TapTopic topic, const TapTarget& target) : topic_(std::move(topic)), target_(target) {}

  /// Takes the reader whose listener this is. Samples may arrive earlier.
  void open(dds::SerializedReader reader) { reader_ = std::move(reader); }
  /// Stops the arrival of samples.
  void close() { reader_ = dds::core::null; }

  [[nodiscard]] const std::string& name() const { return topic_.name; }
  [[nodiscard]] TapCounts counts() const { return {received_, lost_queue_, lost_dds_}; }
  /// Addresses of the latest beacon that was recorded, and of the latest that was left out; all_beacons
  /// without one.
  [[nodiscard]] BeaconAddress recorded_beacon() const { return recorded_beacon_; }
  [[nodiscard]] BeaconAddress left_out_beacon() const { return left_out_beacon_; }
  /// Number of ends of instances among the received.
  [[nodiscard]] std::uint64_t ends() const { return ends_; }
  /// Number of writers whose QoS does not match the reader's.
  [[nodiscard]] std::uint64_t incompatible() const { return incompatible_; }

  void on_data_available(dds::SerializedReader& reader) noexcept override;
  void on_sample_lost(dds::SerializedReader& reader,
                      const dds::core::status::SampleLostStatus& status) noexcept override;
  void on_requested_incompatible_qos(
      dds::SerializedReader& reader,
      const dds::core::status::RequestedIncompatibleQosStatus& status) noexcept override;

private:
  [[nodiscard]] bool accepts(std::span<const std::byte> sample) noexcept;
  void on_sample(const dds::SerializedSample& sample, const dds::sub::SampleInfo& info) noexcept;
  void on_end(const dds::SerializedSample& key, const dds::sub::SampleInfo& info) noexcept;
  void add(const mcap::Message& message, std::span<const std::byte> head = {}) noexcept;

  TapTopic topic_;
  TapTarget target_;
  std::atomic<std::uint32_t> sequence_ = 0;
  std::atomic<std::uint64_t> received_ = 0;
  std::atomic<std::uint64_t> ends_ = 0;
  std::atomic<BeaconAddress> recorded_beacon_ = all_beacons;
  std::atomic<BeaconAddress> left_out_beacon_ = all_beacons;
  std::atomic<std::uint64_t> lost_queue_ = 0;
  std::atomic<std::uint64_t> lost_dds_ = 0;
  std::atomic<std::uint64_t> incompatible_ = 0;
  dds::SerializedReader reader_ = dds::core::null;  ///< last, because its listener is this object
};

}  // namespace sonopose::recorder
