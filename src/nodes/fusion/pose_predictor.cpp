#include "fusion/pose_predictor.hpp"

#include <sonopose/estimation/prediction.hpp>

namespace sonopose::fusion {

bool PosePredictor::set_period(BeaconAddress address, TimeNs period_ns) {
  PredictedBeacon& beacon = beacons_[address];
  if (beacon.period_ns == period_ns) return false;
  beacon.period_ns = period_ns;
  beacon.due = {};
  return true;
}

bool PosePredictor::on_pose(const FusedPose& pose, SteadyTime now) {
  const auto found = beacons_.find(pose.address);
  if (found == beacons_.end() || found->second.period_ns == 0) return false;
  PredictedBeacon& beacon = found->second;
  const bool first = beacon.due == SteadyTime{};
  if (first) beacon.due = now + beacon.period_ns;
  beacon.taken = now;
  beacon.pose = pose;
  return first;
}

std::optional<FusedPose> PosePredictor::predicted(const PredictedBeacon& beacon, SteadyTime now) const {
  const TimeNs age_ns = now - beacon.taken;
  if (beacon.taken == SteadyTime{} || age_ns <= 0 || age_ns >= deadline_ns_) return std::nullopt;
  if ((beacon.pose.status & status_overloaded) != 0) return std::nullopt;  // the fusion saves its time
  return estimation::predicted(beacon.pose, age_ns);
}

}  // namespace sonopose::fusion
