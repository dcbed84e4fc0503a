#pragma once
/// \file
/// When which beacon's pose is due between its IMU samples: the part that decides.

#include <sonopose/samples/pose.hpp>

#include <optional>
#include <unordered_map>

namespace sonopose::fusion {

/// The latest pose of each beacon that is to be predicted on. Times are of the steady clock. Not for several
/// threads at once: no locks. Allocates where a beacon is new alone.
class PosePredictor {
public:
  /// `deadline_ns`: so long after an IMU sample nothing is predicted from it any more.
  explicit PosePredictor(TimeNs deadline_ns) : deadline_ns_(deadline_ns) {}

  /// A beacon's poses are due every `period_ns`; 0: never. Returns whether that is new: the next one is due
  /// a period after the next sample then.
  bool set_period(BeaconAddress address, TimeNs period_ns);

  /// The pose of an IMU sample that was taken at `now`.
  void on_pose(const FusedPose& pose, SteadyTime now);

  /// Calls `on_due(const FusedPose&)` with every predicted pose that is due at `now`: one for each beacon
  /// at most, for what was due earlier is past. Returns when the next one is; empty where none ever.
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
