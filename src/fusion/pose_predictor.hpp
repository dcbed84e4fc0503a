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

  /// The pose of an IMU sample that was taken at `now_ns`.
  void on_pose(const FusedPose& pose, TimeNs now_ns);

  /// Calls `on_due(const FusedPose&)` with every predicted pose that is due at `now_ns`: one for each beacon
  /// at most, for what was due earlier is past. Returns when the next one is; empty where none ever.
  template <class OnDue>
  std::optional<TimeNs> predict(TimeNs now_ns, const OnDue& on_due) {
    std::optional<TimeNs> next_ns;
    for (auto& entry : lanes_) {
      Lane& lane = entry.second;
      if (lane.period_ns == 0 || lane.due_ns == 0) continue;
      if (now_ns >= lane.due_ns) {
        if (const auto pose = predicted(lane, now_ns)) on_due(*pose);
        lane.due_ns += ((now_ns - lane.due_ns) / lane.period_ns + 1) * lane.period_ns;
      }
      if (!next_ns || lane.due_ns < *next_ns) next_ns = lane.due_ns;
    }
    return next_ns;
  }

private:
  struct Lane {
    TimeNs period_ns = 0;
    TimeNs due_ns = 0;
    TimeNs taken_ns = 0;  ///< when the latest IMU sample was; 0: none yet
    FusedPose pose;
  };

  [[nodiscard]] std::optional<FusedPose> predicted(const Lane& lane, TimeNs now_ns) const;

  TimeNs deadline_ns_;
  std::unordered_map<BeaconAddress, Lane> lanes_;
};

}  // namespace sonopose::fusion
