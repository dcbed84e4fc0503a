#pragma once
/// \file
/// The writers of all topics that a bridge publishes.

#include "process/endpoint_counters.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::publication {

/// Writes samples and statuses, and waits for their readers. Not thread-safe.
class TopicWriters {
public:
  /// `batch`: the domain batches writes, which wait for `flush`. Throws dds::core::Exception.
  TopicWriters(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
               dds::topics::Delivery delivery, bool batch);

  /// Ends lossless writes and the waits below when `stop` is requested.
  void obey(const process::StopSignal& stop) { stop_ = &stop; }

  void write(const ImuSample& sample) { write(imu_, dds::topics::to_idl(sample)); }
  void write(const UltrasonicFix& fix) { write(fix_, dds::topics::to_idl(fix)); }
  void write(const PairHeading& heading) { write(heading_, dds::topics::to_idl(heading)); }
  void write(const TwistSample& twist) { write(twist_, dds::topics::to_idl(twist)); }
  void write(const TruthSample& truth) { write(truth_, dds::topics::to_idl(truth)); }
  void write(const BeaconStatus& status) { write(status_, dds::topics::to_idl(status)); }
  void write(const LineStatus& line) { write(line_, dds::topics::to_idl(line)); }
  void write(const StationaryBeacon& beacon) { write(stationary_, dds::topics::to_idl(beacon)); }
  void flush();

  /// Unregisters a beacon, so that its instances miss no deadlines at the readers.
  void unregister(BeaconAddress address);
  void unregister(const LineStatus& line) {
    dds::ext::try_unregister_instance(line_, dds::topics::to_idl(line));
  }
  void unregister(const StationaryBeacon& beacon) {
    dds::ext::try_unregister_instance(stationary_, dds::topics::to_idl(beacon));
  }

  /// Waits until each stream has a reader. Call `obey` before.
  void wait_for_readers();
  /// Waits until the readers have received everything, for up to 30 s for each topic. Returns the topics of
  /// which some have not.
  std::vector<std::string> wait_until_read();
  /// True if the IMU stream has a reader.
  [[nodiscard]] bool has_reader();

  [[nodiscard]] const dds::pub::AnyDataWriter& imu() const { return imu_; }
  [[nodiscard]] const dds::pub::AnyDataWriter& fix() const { return fix_; }
  [[nodiscard]] const dds::pub::AnyDataWriter& heading() const { return heading_; }
  [[nodiscard]] const dds::pub::AnyDataWriter& status() const { return status_; }
  [[nodiscard]] const process::EndpointCounters& endpoints() const { return endpoints_; }
  /// Number of samples that could not be written.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }
  [[nodiscard]] bool stopped() const { return stop_ != nullptr && stop_->requested(); }

private:
  template <class T>
  void write(dds::pub::DataWriter<T>& writer, const T& sample) {
    const auto give_up = [this] { return !lossless_ || stopped(); };
    if (dds::ext::retry_unless(give_up, [&] { return dds::ext::try_write(writer, sample); }) < 0)
      ++unwritten_;
  }

  const bool lossless_;
  const bool batch_;
  const process::StopSignal* stop_ = nullptr;
  std::uint64_t unwritten_ = 0;
  process::EndpointCounters endpoints_;
  process::CountingWriterListener<sonopose_ImuSample> imu_listener_{endpoints_};
  process::CountingWriterListener<sonopose_UltrasonicFix> fix_listener_{endpoints_};
  process::CountingWriterListener<sonopose_PairHeading> heading_listener_{endpoints_};
  process::CountingWriterListener<sonopose_TwistSample> twist_listener_{endpoints_};
  dds::pub::DataWriter<sonopose_ImuSample> imu_;
  dds::pub::DataWriter<sonopose_UltrasonicFix> fix_;
  dds::pub::DataWriter<sonopose_PairHeading> heading_;
  dds::pub::DataWriter<sonopose_TwistSample> twist_;
  dds::pub::DataWriter<sonopose_TruthSample> truth_;
  dds::pub::DataWriter<sonopose_BeaconStatus> status_;
  dds::pub::DataWriter<sonopose_LineStatus> line_;
  dds::pub::DataWriter<sonopose_StationaryBeacon> stationary_;
};

}  // namespace sonopose::publication
