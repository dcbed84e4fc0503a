#include <sonopose/estimation/documented/output.hpp>
#include "fusion/pose_predictor.hpp"

namespace sonopose::fusion {

bool PosePredictor::set_period(BeaconAddress address, TimeNs period_ns) {
  Lane& lane = lanes_[address];
  if (lane.period_ns == period_ns) return false;
  lane.period_ns = period_ns;
  lane.due_ns = 0;
  return true;
}

void PosePredictor::on_pose(const FusedPose& pose, TimeNs now_ns) {
  const auto found = lanes_.find(pose.address);
  if (found == lanes_.end() || found->second.period_ns == 0) return;
  Lane& lane = found->second;
  if (lane.due_ns == 0) lane.due_ns = now_ns + lane.period_ns;
  lane.taken_ns = now_ns;
  lane.pose = pose;
}

std::optional<FusedPose> PosePredictor::predicted(const Lane& lane, TimeNs now_ns) const {
  const TimeNs age_ns = now_ns - lane.taken_ns;
  if (lane.taken_ns == 0 || age_ns <= 0 || age_ns >= deadline_ns_) return std::nullopt;
  return estimation::documented::output::predicted(lane.pose, age_ns);
}

}  // namespace sonopose::fusion
