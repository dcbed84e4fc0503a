#include "ros2/relay/fix_queue.hpp"

#include <algorithm>

namespace sonopose::ros2::relay {

FixQueue::Ready FixQueue::on(const UltrasonicFix& fix, SteadyTime now, bool fusion_runs) {
  Ready ready;
  const Waiting one{{fix.sequence, fix.emission_time_ns}, fix.position_world_m, fix.covariance_world_m2, now};
  if (is_released(one.key)) return ready;  // the report arrived first
  if (!fusion_runs) {
    while (waiting_count_ > 0) release_first(ready);
    release(one, std::nullopt, ready);
    return ready;
  }
  if (waiting_count_ == max_waiting) release_first(ready);
  waiting_[waiting_count_++] = one;
  return ready;
}

FixQueue::Ready FixQueue::on(const FixReport& report) {
  Ready ready;
  const Key key{report.sequence, report.emission_time_ns};
  if (is_released(key)) return ready;  // another fusion has reported on it
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_);
  const auto found =
      std::find_if(waiting_.begin(), end, [&key](const Waiting& one) { return one.key == key; });
  Waiting reported{key, report.position_world_m, std::nullopt, {}};
  if (found != end) {
    reported = *found;
    for (auto before = found - waiting_.begin(); before > 0; --before) release_first(ready);
    remove_first();
  }
  release(reported, report.weight, ready);
  return ready;
}

FixQueue::Ready FixQueue::overdue(SteadyTime now) {
  Ready ready;
  while (has_overdue(now)) release_first(ready);
  return ready;
}

bool FixQueue::has_overdue(SteadyTime now) const {
  return waiting_count_ > 0 && now - waiting_[0].since > timeout_ns;
}

void FixQueue::remove_first() {
  std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
            waiting_.begin());
  --waiting_count_;
}

void FixQueue::release_first(Ready& ready) {
  const Waiting first = waiting_[0];
  remove_first();
  release(first, std::nullopt, ready);
}

void FixQueue::release(const Waiting& fix, std::optional<double> weight, Ready& ready) {
  released_[next_released_] = fix.key;
  next_released_ = (next_released_ + 1) % released_.size();
  ready.fixes[ready.count++] = {fix.position_world_m, fix.key.emission_time_ns, fix.covariance_world_m2,
                                weight};
}

bool FixQueue::is_released(const Key& key) const {
  return std::find(released_.begin(), released_.end(), key) != released_.end();
}

}  // namespace sonopose::ros2::relay
