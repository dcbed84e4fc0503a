#pragma once
/// \file
/// Writes the poses of a fusion process: selects each pose's ownership strength, asserts liveliness, and
/// writes predicted poses between IMU samples.

#include "fusion/bridge_backlog.hpp"
#include "fusion/lateness.hpp"
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
#include <unordered_map>
#include <vector>

namespace sonopose::fusion {

/// Output of poses. One thread delivers poses, another calls `poll` and `hand_over`, and a third writes
/// predicted poses. No lock is held during a write.
///
/// A standby process has two writers: one with its own strength for the beacons that it serves, and one of
/// strength 0 for those that warm up. Ownership strength belongs to a writer, and changing it is not ordered
/// with the samples. With two writers, each beacon is claimed and released within its own stream.
class PoseOutput {
public:
  /// `input_deadline_ns`: silence of an IMU after which its pose is not predicted and its beacon is released.
  PoseOutput(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
             dds::topics::Delivery delivery, const std::optional<StandbyOptions>& standby,
             TimeNs input_deadline_ns, process::EndpointCounters& counters);
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;
  ~PoseOutput();

  /// Predicts this beacon's poses every `period_ns`, starting with its next pose; 0: never.
  void set_period(BeaconAddress address, TimeNs period_ns) noexcept;

  /// Writer of a pose, and lateness of its sample above the usual.
  struct Route {
    dds::DataWriter<sonopose_FusedPose>* writer = nullptr;  ///< null: the pose is skipped and counted
    TimeNs late_ns = 0;
  };
  /// Selects the route of a pose that is written at `now`. Releases the beacon if necessary. A standby skips
  /// the backlog of a pause. Live, marks and counts a late pose: its sample arrived more than `late_after_s`
  /// later than usual, or left a stopped bridge that late.
  Route route(FusedPose& pose, SteadyTime now) noexcept;
  static constexpr double late_after_s = sonopose_LATE_AFTER;

  /// True if this pose is at least `spacing_ns` after the beacon's latest routed pose.
  [[nodiscard]] bool is_due(const FusedPose& pose, TimeNs spacing_ns) const noexcept;

  /// Counts a pose that is not written because there is a newer one.
  void count_skipped(BeaconAddress address) noexcept;

  /// Stamps and writes a pose.
  dds::ReturnCode write(dds::DataWriter<sonopose_FusedPose>& writer, FusedPose& pose) noexcept;

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

  /// Forgets and unregisters this beacon, so that readers learn that its poses end.
  void unregister(BeaconAddress address) noexcept;

  [[nodiscard]] bool is_standby() const { return standby_.has_value(); }
  [[nodiscard]] FusionRole role(BeaconAddress address) const noexcept;
  [[nodiscard]] std::uint64_t poses_late(BeaconAddress address) const noexcept;
  [[nodiscard]] std::uint64_t poses_skipped(BeaconAddress address) const noexcept;
  [[nodiscard]] std::int32_t strength() const { return strength_; }
  [[nodiscard]] TimeNs lease_ns() const { return lease_ns_; }
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

private:
  void serve_predictions(const std::stop_token& stop);
  std::optional<SteadyTime> write_predictions(std::vector<FusedPose>& due);
  void release(BeaconAddress address) noexcept;
  dds::DataWriter<sonopose_FusedPose>& writer_of(FusionRole role) noexcept;

  struct Delay {
    Lateness lateness;
    BridgeBacklog bridge_backlog{to_ns(late_after_s)};
    TimeNs latest_ns = 0;  ///< time of the latest pose
    std::uint64_t poses_late = 0;
    std::uint64_t poses_skipped = 0;
  };

  mutable std::mutex mutex_;  // guards standby_, predictor_ and delays_; not held during a write
  std::optional<Standby> standby_;
  PosePredictor predictor_;
  std::unordered_map<BeaconAddress, Delay> delays_;
  std::condition_variable_any wake_;  // wakes the predicting thread early
  bool due_times_changed_ = false;
  std::vector<BeaconAddress> stalled_;  // kept for its capacity
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::atomic<std::int64_t> written_ns_ = 0;  // steady time of the latest pose

  process::CountingWriterListener<sonopose_FusedPose> listener_;
  dds::DataWriter<sonopose_FusedPose> writer_;
  dds::DataWriter<sonopose_FusedPose> warming_writer_;
  std::int32_t strength_ = 0;
  TimeNs lease_ns_ = 0;
  bool is_manual_ = false;
  bool is_live_ = true;  // false: log time differs from clock time
  std::jthread predicting_thread_;
};

}  // namespace sonopose::fusion
