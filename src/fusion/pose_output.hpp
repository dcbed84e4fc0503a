#pragma once
/// \file
/// The pose end of a fusion process: its writers, whose strength each pose is written with, the liveliness of
/// its claim, and the poses predicted between IMU samples.

#include "fusion/pose_predictor.hpp"
#include "fusion/standby.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace sonopose::fusion {

/// Poses come from one thread, `watch` and `hand_over` from another one; a third writes predicted poses.
/// No lock is held while something is written.
///
/// A standby process has two writers: one with its own strength for the beacons that it serves, and one of
/// strength 0 for those that warm up. Ownership strength belongs to a writer, and a change of it travels
/// apart from the samples; with two writers each beacon's claim is made, and given up, in its own stream.
class PoseOutput {
public:
  /// `input_deadline_ns`: an IMU that is silent for so long is not predicted on, and its beacon is given up.
  PoseOutput(const dds::DomainParticipant& participant, const dds::QosProvider& qos, dds::Delivery delivery,
             const std::optional<StandbyOptions>& standby, TimeNs input_deadline_ns,
             process::EndpointCounters& counters);
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;
  ~PoseOutput();

  /// From this beacon's next pose on it is predicted every `period_ns`; 0: never.
  void set_period(BeaconAddress address, TimeNs period_ns) noexcept;

  /// The writer for the pose of an IMU sample that was taken at `now`. Takes a claim back where it
  /// must.
  dds::DataWriter<sonopose_FusedPose>& writer_for(const FusedPose& pose, SteadyTime now) noexcept;

  /// Shows life where liveliness is manual, unless `busy`, and gives stalled beacons up. To be called several
  /// times within a lease.
  void watch(SteadyTime now, bool busy) noexcept;

  /// When `watch` must be called the latest.
  [[nodiscard]] SteadyTime watch_by(SteadyTime now) const noexcept;

  /// Ends predicting, and makes every claim be taken back with its beacon's next pose: serve on for
  /// `lease_ns`, and nothing is missed.
  void hand_over() noexcept;

  /// Tells readers that this beacon's poses end.
  void unregister(BeaconAddress address) noexcept;

  [[nodiscard]] bool is_standby() const { return standby_.has_value(); }
  [[nodiscard]] FusionRole role(BeaconAddress address) const noexcept;
  [[nodiscard]] std::int32_t strength() const { return strength_; }
  [[nodiscard]] TimeNs lease_ns() const { return lease_ns_; }
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

private:
  void serve_predictions(const std::stop_token& stop);
  std::optional<SteadyTime> write_predictions(std::vector<FusedPose>& due);
  void take_back(BeaconAddress address) noexcept;
  dds::DataWriter<sonopose_FusedPose>& writer_of(FusionRole role) noexcept;

  mutable std::mutex mutex_;  // guards standby_ and predictor_, for computing alone
  std::optional<Standby> standby_;
  PosePredictor predictor_;
  std::condition_variable_any wake_;  // of the predicting thread, before its time
  bool periods_changed_ = false;
  std::vector<BeaconAddress> stalled_;  // of watch(), kept for its capacity
  std::atomic<std::uint64_t> unwritten_ = 0;

  process::CountingWriterListener<sonopose_FusedPose> listener_;
  dds::DataWriter<sonopose_FusedPose> writer_;
  dds::DataWriter<sonopose_FusedPose> warming_writer_;
  std::int32_t strength_ = 0;
  TimeNs lease_ns_ = 0;
  bool is_manual_ = false;
  std::jthread predicting_thread_;
};

}  // namespace sonopose::fusion
