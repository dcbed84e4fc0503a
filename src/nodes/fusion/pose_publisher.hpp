#pragma once
/// \file
/// Publishes the results of the estimators: poses, predicted poses between IMU samples, and the report of
/// each fix.

#include "fusion/beacon_estimator.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_predictor.hpp"
#include "fusion/sample_age.hpp"
#include "fusion/standby.hpp"
#include "process/endpoint_counters.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <optional>
#include <thread>
#include <unordered_map>
#include <vector>

namespace sonopose::fusion {

/// Publishes poses and fix reports. It chooses the ownership strength of each pose, marks late poses, and
/// asserts liveliness. It holds no lock of its own during a write. One thread at a time calls `publish` and
/// `publish_held_back`, one thread `poll` and `hand_over`; any thread calls the others.
///
/// A standby process has two writers: one with its own strength for the beacons that it serves, and one of
/// strength 0 for those that warm up. Ownership strength belongs to a writer, and changing it is not ordered
/// with the samples. With two writers, each beacon is claimed and released within its own stream.
class PosePublisher {
public:
  /// `input_deadline_ns`: silence of an IMU after which its pose is not predicted and its beacon is released.
  /// Lossless writers wait for consumers until `stopping` is set. All references must outlive it.
  PosePublisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                dds::topics::Delivery delivery, const std::optional<StandbyOptions>& standby,
                TimeNs input_deadline_ns, Overload& overload, process::EndpointCounters& counters,
                const std::atomic<bool>& stopping);
  PosePublisher(const PosePublisher&) = delete;
  PosePublisher& operator=(const PosePublisher&) = delete;
  ~PosePublisher();

  /// Publishes the result of an event that the fusion took at the host time `in_ns`. During an overload,
  /// holds a pose back in case a newer one follows.
  void publish(EventOutcome& outcome, BeaconAddress address, TimeNs in_ns) noexcept;

  /// Publishes the pose that was held back, unless another was written shortly before.
  void publish_held_back() noexcept;

  /// Age of a sample after which its pose is marked as late.
  static constexpr double late_after_s = sonopose_LATE_AFTER;

  /// Asserts manual liveliness unless `busy` or a pose has done so, and releases stalled beacons. Call it by
  /// `poll_by`.
  void poll(SteadyTime now, bool busy) noexcept;

  /// Latest time of the next `poll`.
  [[nodiscard]] SteadyTime poll_by(SteadyTime now) const noexcept;

  /// Time until which `poll` has nothing to do, because a pose has asserted liveliness within the last tick.
  /// Empty without such a pose, and for a standby, whose beacons may stall.
  [[nodiscard]] std::optional<SteadyTime> asserted_until(SteadyTime now) const noexcept;

  /// Period of the assertions of liveliness while no pose is written.
  [[nodiscard]] TimeNs tick_ns() const noexcept;

  /// Stops predicting, and releases each beacon with its next pose. Continue for `lease_ns`, so that no pose
  /// is missed.
  void hand_over() noexcept;

  /// Forgets a beacon and, if live, unregisters it, so that readers learn that its poses and reports end.
  /// Lossless writers would block until there is space; their consumers learn it when the writers end.
  void unregister(BeaconAddress address) noexcept;

  /// State of a beacon's poses, for its status.
  struct BeaconOutput {
    FusionRole role = FusionRole::sole;
    std::uint64_t poses_late = 0;
    std::uint64_t poses_skipped = 0;
  };
  [[nodiscard]] BeaconOutput output_of(BeaconAddress address) const noexcept;

  [[nodiscard]] bool is_standby() const { return is_standby_; }
  [[nodiscard]] std::int32_t strength() const { return strength_; }
  [[nodiscard]] TimeNs lease_ns() const { return lease_ns_; }

  /// Number of poses and reports that DDS did not accept.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

  /// True if it has waited for a lossless consumer since the last call.
  bool take_waited() { return waited_.exchange(false); }

private:
  using PoseWriter = dds::pub::DataWriter<sonopose_FusedPose>;

  struct Delay {
    SampleAge age{to_ns(late_after_s)};
    TimeNs latest_ns = 0;  ///< time of the latest pose
    std::uint64_t poses_late = 0;
    std::uint64_t poses_skipped = 0;
  };

  void set_period(BeaconAddress address, TimeNs period_ns) noexcept;
  void publish(FusedPose& pose) noexcept;
  [[nodiscard]] PoseWriter* admit(FusedPose& pose, SteadyTime now) noexcept;
  [[nodiscard]] bool is_due(const FusedPose& pose) const noexcept;
  void count_skipped(BeaconAddress address) noexcept;
  void write(PoseWriter& writer, FusedPose& pose) noexcept;
  void write_until_accepted(const auto& attempt) noexcept;
  void serve_predictions(const std::stop_token& stop);
  std::optional<SteadyTime> write_predictions(std::vector<FusedPose>& due);
  void release(BeaconAddress address) noexcept;
  PoseWriter& writer_of(FusionRole role) noexcept;
  [[nodiscard]] FusionRole role(BeaconAddress address) const SONOPOSE_REQUIRES(mutex_);

  const bool is_live_;  // false: log time differs from clock time
  const bool is_standby_;
  std::int32_t strength_ = 0;
  TimeNs lease_ns_ = 0;
  bool is_manual_ = false;
  Overload& overload_;
  const std::atomic<bool>& stopping_;

  mutable threads::Mutex mutex_;
  std::optional<Standby> standby_ SONOPOSE_GUARDED_BY(mutex_);
  PosePredictor predictor_ SONOPOSE_GUARDED_BY(mutex_);
  std::unordered_map<BeaconAddress, Delay> delays_ SONOPOSE_GUARDED_BY(mutex_);
  bool due_times_changed_ SONOPOSE_GUARDED_BY(mutex_) = false;
  std::condition_variable_any wake_;  // wakes the predicting thread early

  std::optional<FusedPose> held_back_;  // publishing thread only
  std::vector<BeaconAddress> stalled_;  // polling thread only; kept for its capacity
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::atomic<bool> waited_ = false;
  std::atomic<std::int64_t> written_ns_ = 0;  // steady time of the latest pose

  process::CountingWriterListener<sonopose_FusedPose> pose_listener_;
  process::CountingWriterListener<sonopose_FixReport> report_listener_;
  PoseWriter writer_ = dds::core::null;
  PoseWriter warming_writer_ = dds::core::null;
  dds::pub::DataWriter<sonopose_FixReport> report_writer_;
  std::jthread predicting_thread_;
};

}  // namespace sonopose::fusion
