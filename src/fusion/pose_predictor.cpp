#include "fusion/pose_predictor.hpp"

#include <sonopose/estimation/prediction.hpp>

namespace sonopose::fusion {

bool PosePredictor::set_period(BeaconAddress address, TimeNs period_ns) {
  Lane& lane = lanes_[address];
  if (lane.period_ns == period_ns) return false;
  lane.period_ns = period_ns;
  lane.due = {};
  return true;
}

bool PosePredictor::on_pose(const FusedPose& pose, SteadyTime now) {
  const auto found = lanes_.find(pose.address);
  if (found == lanes_.end() || found->second.period_ns == 0) return false;
  Lane& lane = found->second;
  const bool first = lane.due == SteadyTime{};
  if (first) lane.due = now + lane.period_ns;
  lane.taken = now;
  lane.pose = pose;
  return first;
}

std::optional<FusedPose> PosePredictor::predicted(const Lane& lane, SteadyTime now) const {
  const TimeNs age_ns = now - lane.taken;
  if (lane.taken == SteadyTime{} || age_ns <= 0 || age_ns >= deadline_ns_) return std::nullopt;
  if ((lane.pose.status & status_overloaded) != 0) return std::nullopt;  // the fusion saves its time
  return estimation::predicted(lane.pose, age_ns);
}

}  // namespace sonopose::fusion
