#include "evaluation/score/comparison.hpp"

#include <utility>

namespace sonopose::evaluation {

void Comparison::add(const FusedPose& pose) {
  scorer_.add(pose);
  if (pose.time_ns < from_ns_) return;
  const TimeNs before_ns = std::exchange(before_ns_, pose.time_ns);
  const auto fix_world_m = baseline_.last_fix();
  if (!fix_world_m) return;
  const auto truth = truth_.at_or_since(before_ns, pose.time_ns);
  if (!truth || !truth->position_world_m.allFinite()) return;
  last_fix_m_.push_back((*fix_world_m - truth->position_world_m).norm());
  extrapolated_m_.push_back((*baseline_.extrapolated(truth->time_ns) - truth->position_world_m).norm());
}

}  // namespace sonopose::evaluation
