#pragma once
/// \file
/// Decides when the pose of each beacon is due between its IMU samples.

#include <sonopose/samples/pose.hpp>

#include <optional>
#include <unordered_map>

namespace sonopose::fusion {

/// The latest pose of each beacon with predicted poses. Not thread-safe. Allocates only for a new beacon.
class PosePredictor {
public:
  /// `deadline_ns`: no prediction from an IMU sample that is older than this.
  explicit PosePredictor(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  /// Sets the period of a beacon's poses; 0: never. Returns whether it has changed; then the next pose is due
  /// one period after the next sample.
  bool set_period(BeaconAddress address, TimeNs period_ns);

  /// The pose of an IMU sample that was taken at `now`. Returns whether it is the first since the period was
  /// set, which makes predicted poses due.
  bool on_pose(const FusedPose& pose, SteadyTime now);

  void forget(BeaconAddress address) { lanes_.erase(address); }

  /// Calls `on_due(const FusedPose&)` with every predicted pose that is due at `now`: at most one per beacon.
  /// Returns when the next one is due; empty if never.
  template <class OnDue>
  std::optional<SteadyTime> predict(SteadyTime now, const OnDue& on_due) {
    std::optional<SteadyTime> next;
    for (auto& entry : lanes_) {
      Lane& lane = entry.second;
      if (lane.period_ns == 0 || lane.due == SteadyTime{}) continue;
      if (now >= lane.due) {
        if (const auto pose = predicted(lane, now)) on_due(*pose);
        lane.due += ((now - lane.due) / lane.period_ns + 1) * lane.period_ns;
      }
      if (!next || lane.due < *next) next = lane.due;
    }
    return next;
  }

private:
  struct Lane {
    TimeNs period_ns = 0;
    SteadyTime due;
    SteadyTime taken;  ///< when the latest IMU sample was; 0: none yet
    FusedPose pose;
  };

  [[nodiscard]] std::optional<FusedPose> predicted(const Lane& lane, SteadyTime now) const;

  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, Lane> lanes_;
};

}  // namespace sonopose::fusion
