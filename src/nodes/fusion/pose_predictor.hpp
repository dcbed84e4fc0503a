#pragma once
/// \file
/// Schedules each beacon's poses between its IMU samples.

#include <sonopose/samples/pose.hpp>

#include <optional>
#include <unordered_map>

namespace sonopose::fusion {

/// The latest pose of each beacon with predicted poses. Not thread-safe. Allocates only for a new beacon.
class PosePredictor {
public:
  /// `deadline_ns`: greatest age of an IMU sample to predict from.
  explicit PosePredictor(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  /// Sets the period of a beacon's poses; 0: never. Returns true if it has changed; the next pose is then due
  /// one period after the next sample.
  bool set_period(BeaconAddress address, TimeNs period_ns);

  /// Takes the pose of an IMU sample that was taken at `now`. Returns true if it is the first since the
  /// period was set, which makes predicted poses due.
  bool on_pose(const FusedPose& pose, SteadyTime now);

  void forget(BeaconAddress address) { beacons_.erase(address); }

  /// Calls `on_due(const FusedPose&)` with each predicted pose that is due at `now`, at most one per beacon.
  /// Returns the next due time; empty if never.
  template <class OnDue>
  std::optional<SteadyTime> predict(SteadyTime now, const OnDue& on_due) {
    std::optional<SteadyTime> next;
    for (auto& entry : beacons_) {
      PredictedBeacon& beacon = entry.second;
      if (beacon.period_ns == 0 || beacon.due == SteadyTime{}) continue;
      if (now >= beacon.due) {
        if (const auto pose = predicted(beacon, now)) on_due(*pose);
        beacon.due += ((now - beacon.due) / beacon.period_ns + 1) * beacon.period_ns;
      }
      if (!next || beacon.due < *next) next = beacon.due;
    }
    return next;
  }

private:
  struct PredictedBeacon {
    TimeNs period_ns = 0;
    SteadyTime due;
    SteadyTime taken;  ///< time of the latest IMU sample; 0: none yet
    FusedPose pose;
  };

  [[nodiscard]] std::optional<FusedPose> predicted(const PredictedBeacon& beacon, SteadyTime now) const;

  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, PredictedBeacon> beacons_;
};

}  // namespace sonopose::fusion
