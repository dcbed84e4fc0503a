#include "ros2/inputs/imu_joiner.hpp"

#include <algorithm>
#include <iterator>

namespace sonopose::ros2 {

void ImuJoiner::on(const ros2::ReceivedImu& received, SteadyTime now, std::vector<ImuSample>& ready) {
  const ImuSample& sample = received.sample;
  if (received.has_angular_velocity && received.has_specific_force) {
    ready.push_back(sample);
    return;
  }
  if (received.has_angular_velocity) {
    if (waiting_.size() == max_waiting) release_first(ready);
    waiting_.push_back({sample, now});
  } else if (received.has_specific_force) {
    if (!forces_.empty() && sample.sensor_time_ns <= forces_.back().time_ns) forces_.clear();  // a new start
    if (forces_.size() == max_waiting) forces_.pop_front();
    forces_.push_back({sample.sensor_time_ns, sample.specific_force_body_mps2});
  }
  update(now, ready);
}

void ImuJoiner::update(SteadyTime now, std::vector<ImuSample>& ready) {
  const auto can_leave = [&](const Waiting& first) {
    const bool has_later = !forces_.empty() && forces_.back().time_ns >= first.sample.sensor_time_ns;
    return has_later || now - first.since >= max_wait_ns;
  };
  while (!waiting_.empty() && can_leave(waiting_.front())) release_first(ready);
}

void ImuJoiner::release_first(std::vector<ImuSample>& ready) {
  ImuSample sample = waiting_.front().sample;
  waiting_.pop_front();
  const auto force = force_at(sample.sensor_time_ns);
  if (!force) {
    ++dropped_;
    return;
  }
  sample.specific_force_body_mps2 = *force;
  ++joined_;
  ready.push_back(sample);
}

std::optional<Vector3d> ImuJoiner::force_at(TimeNs time_ns) const {
  const auto after = std::find_if(forces_.begin(), forces_.end(),
                                  [time_ns](const Force& each) { return each.time_ns >= time_ns; });
  const bool has_after = after != forces_.end() && after->time_ns - time_ns <= max_age_ns;
  const bool has_before = after != forces_.begin() && time_ns - std::prev(after)->time_ns <= max_age_ns;
  if (!has_after && !has_before) return std::nullopt;
  if (!has_after) return std::prev(after)->force_body_mps2;
  if (!has_before) return after->force_body_mps2;
  const Force& before = *std::prev(after);
  const double share =
      seconds_between(before.time_ns, time_ns) / seconds_between(before.time_ns, after->time_ns);
  return before.force_body_mps2 + share * (after->force_body_mps2 - before.force_body_mps2);
}

}  // namespace sonopose::ros2
