#pragma once
// What a fusion process is made of. Its way from events to poses stands in fusion_node.cpp, what it tells of
// itself in fusion_node_status.cpp.

#include "fusion/beacon_estimators.hpp"
#include "fusion/fusion_node.hpp"
#include "fusion/gap_detector.hpp"
#include "fusion/input_monitor.hpp"
#include "fusion/pose_output.hpp"
#include "process/clocks.hpp"
#include "process/endpoint_counters.hpp"
#include "process/silence_detector.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace sonopose::fusion {

class FusionNode::Impl {
public:
  explicit Impl(const FusionOptions& options);
  ~Impl();

  void publish_statuses();

  /// Shows life, gives stalled beacons up and tells at once of an IMU that fell silent or came back.
  void watch();
  [[nodiscard]] SteadyTime watch_by() const { return output_.watch_by(process::steady_now()); }

  /// Lets a process that stands by take over, without a pose being missed.
  void hand_over();

private:
  template <class T>
  void take(dds::DataReader<T>& reader) noexcept;
  void take(dds::DataReader<sonopose_ResetCommand>& reader) noexcept;
  void take(dds::DataReader<sonopose_SettingsRequest>& reader) noexcept;
  void feed(const Event& event, dds::InstanceHandle bridge, TimeNs in_ns, SteadyTime steady) noexcept;
  void write(FusedPose& pose, SteadyTime steady) noexcept;
  void write(const SettingsInForce& change) noexcept;
  template <class T>
  void write_to(dds::DataWriter<T>& writer, const T& sample) noexcept;
  void serve_lossless(const std::stop_token& stop);

  void publish_status(BeaconAddress address);
  void log_gaps();
  void log_unwritten();
  void log_incompatible();

  /// Hands on what one topic brings, on the thread that received it, and what the middleware tells of it.
  template <class T>
  class Listener final : public process::CountingReaderListener<T> {
  public:
    explicit Listener(Impl& node) : process::CountingReaderListener<T>(node.ends_), node_(node) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override { node_.take(reader); }
    void on_requested_deadline_missed(dds::DataReader<T>& reader,
                                      const dds::RequestedDeadlineMissedStatus& status) noexcept override {
      node_.on_deadline_missed(reader, status);
    }
    void on_liveliness_changed(dds::DataReader<T>& /*reader*/,
                               const dds::LivelinessChangedStatus& status) noexcept override {
      if (std::is_same_v<T, sonopose_ImuSample>) node_.on_bridge_liveliness(status);
    }

  private:
    Impl& node_;
  };

  template <class T>
  void on_deadline_missed(dds::DataReader<T>& reader,
                          const dds::RequestedDeadlineMissedStatus& status) noexcept;
  void on_bridge_liveliness(const dds::LivelinessChangedStatus& status) noexcept;

  bool lossless_;
  process::AddressSet addresses_;
  std::uint64_t id_;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  dds::Delivery delivery_;
  TimeNs input_deadline_ns_;

  // Guards the engines and what is known of their inputs, for computing alone: nothing is read or written
  // under it.
  std::mutex engines_mutex_;
  BeaconEstimators engines_;
  InputMonitor inputs_;
  process::SilenceDetector imu_silences_;
  std::map<BeaconAddress, std::uint64_t> last_reset_ids_;  // of the receive thread
  // What one event brought about; of the feeding thread, kept for its capacity.
  std::vector<FusedPose> poses_;
  std::vector<FixReport> reports_;
  std::vector<SettingsInForce> changes_;
  std::vector<process::SilenceDetector::Change> silence_changes_;  // of watch(), likewise
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::uint64_t unwritten_reported_ = 0;
  std::uint64_t incompatible_reported_ = 0;
  std::atomic<bool> working_ = false;  // on an event, right now
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> waited_for_consumer_ = false;  // since log_gaps() last asked
  GapDetector gaps_;

  process::EndpointCounters ends_;
  process::CountingWriterListener<sonopose_FixReport> report_listener_{ends_};
  process::CountingWriterListener<sonopose_FusionStatus> status_listener_{ends_};
  PoseOutput output_;
  dds::DataWriter<sonopose_FixReport> report_writer_;
  dds::DataWriter<sonopose_FusionStatus> status_writer_;
  dds::DataWriter<sonopose_SettingsReply> reply_writer_;
  dds::DataWriter<sonopose_EffectiveSettings> settings_writer_;

  Listener<sonopose_ImuSample> imu_listener_{*this};
  Listener<sonopose_UltrasonicFix> fix_listener_{*this};
  Listener<sonopose_PairHeading> heading_listener_{*this};
  Listener<sonopose_ResetCommand> reset_listener_{*this};
  Listener<sonopose_SettingsRequest> request_listener_{*this};
  // Readers last: their listeners may be called while the constructor still runs.
  dds::DataReader<sonopose_ImuSample> imu_reader_;
  dds::DataReader<sonopose_UltrasonicFix> fix_reader_;
  dds::DataReader<sonopose_PairHeading> heading_reader_;
  dds::DataReader<sonopose_ResetCommand> reset_reader_;
  dds::DataReader<sonopose_SettingsRequest> request_reader_;
  std::jthread lossless_thread_;
};

}  // namespace sonopose::fusion
