#pragma once
// What a bridge publishes: samples, as they come (bridge_publisher.cpp), and what it knows of its beacons,
// once a second (bridge_publisher_status.cpp). When it begins and ends stands in bridge_node.cpp.

#include "bridge/beacon_recorder.hpp"
#include "bridge/bridge_node.hpp"
#include "bridge/deadline_count.hpp"
#include "bridge/other_bridges.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdint>
#include <map>
#include <optional>

namespace sonopose::bridge {

class BridgeNode::Publisher final : public SampleSink {
public:
  Publisher(const BridgeOptions& options, const process::StopSignal* stop = nullptr);
  ~Publisher() override;

  void on(const Event& event) override;
  void on(const TruthSample& truth) override;
  void on(const BeaconStatus& status) override;
  void flush() override;
  void tick() override;

  void obey(const process::StopSignal& stop) { stop_ = &stop; }
  void publish_statuses(SteadyTime now);
  void wait_for_readers();
  void wait_until_read();

private:
  /// One stream of one beacon.
  struct Stream {
    explicit Stream(const dds::Entity& writer);
    void note();

    std::uint64_t samples = 0;  ///< of the second that runs
    DeadlineCount deadlines;
  };

  /// What is kept for each address: its numbering, and its status of the second that runs.
  struct Beacon {
    explicit Beacon(const Publisher& publisher)
        : imu(publisher.imu_writer_), fix(publisher.fix_writer_), heading(publisher.heading_writer_) {}

    std::uint64_t next_sequence = 1;
    Stream imu;
    Stream fix;
    Stream heading;
    BeaconStatus status;
  };

  Beacon& beacon_of(BeaconAddress address);
  template <class T>
  void write(dds::DataWriter<T>& writer, const T& sample);
  void publish(ImuSample imu, Beacon& beacon);
  void publish(const UltrasonicFix& fix, Beacon& beacon);
  void publish(const PairHeading& heading, Beacon& beacon);
  void publish_status(Beacon& beacon, SteadyTime now);
  void log_unwritten();
  [[nodiscard]] bool stopped() const { return stop_ != nullptr && stop_->requested(); }

  bool lossless_;
  bool batch_;
  const process::StopSignal* stop_ = nullptr;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  process::EndpointCounters ends_;
  process::CountingWriterListener<sonopose_ImuSample> imu_listener_{ends_};
  process::CountingWriterListener<sonopose_UltrasonicFix> fix_listener_{ends_};
  process::CountingWriterListener<sonopose_PairHeading> heading_listener_{ends_};
  dds::DataWriter<sonopose_ImuSample> imu_writer_;
  dds::DataWriter<sonopose_UltrasonicFix> fix_writer_;
  dds::DataWriter<sonopose_PairHeading> heading_writer_;
  dds::DataWriter<sonopose_TruthSample> truth_writer_;
  dds::DataWriter<sonopose_BeaconStatus> status_writer_;
  OtherBridges others_;
  std::optional<BeaconRecorder> recorder_;
  std::map<BeaconAddress, Beacon> beacons_;
  SteadyTime status_due_;
  SteadyTime status_last_;
  std::uint64_t unwritten_ = 0;
  std::uint64_t unwritten_reported_ = 0;
};

template <class T>
void BridgeNode::Publisher::write(dds::DataWriter<T>& writer, const T& sample) {
  dds::ReturnCode code = writer.try_write(sample);
  while (lossless_ && dds::is_timeout(code) && !stopped()) code = writer.try_write(sample);
  if (code < 0) ++unwritten_;
}

}  // namespace sonopose::bridge
