#include <sonopose/ros2/messages/fix_queue.hpp>

#include <algorithm>

namespace sonopose::ros2 {

FixQueue::Ready FixQueue::on(const UltrasonicFix& fix, SteadyTime now, bool fusion_runs) {
  Ready ready;
  const Key key{fix.sequence, fix.emission_time_ns};
  if (is_released(key)) return ready;  // the report arrived first
  if (!fusion_runs) {
    while (waiting_count_ > 0) release_first(ready);
    release(key, fix.position_world_m, std::nullopt, ready);
    return ready;
  }
  if (waiting_count_ == max_waiting) release_first(ready);
  waiting_[waiting_count_++] = {key, fix.position_world_m, now};
  return ready;
}

FixQueue::Ready FixQueue::on(const FixReport& report) {
  Ready ready;
  const Key key{report.sequence, report.emission_time_ns};
  if (is_released(key)) return ready;  // another fusion has reported on it
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_);
  const auto found =
      std::find_if(waiting_.begin(), end, [&key](const Waiting& one) { return one.key == key; });
  if (found != end) {
    for (auto before = found - waiting_.begin(); before > 0; --before) release_first(ready);
    remove_first();
  }
  release(key, report.position_world_m, report.weight, ready);
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
  release(first.key, first.position_world_m, std::nullopt, ready);
}

void FixQueue::release(const Key& key, const Vector3d& position_world_m, std::optional<double> weight,
                       Ready& ready) {
  released_[next_released_] = key;
  next_released_ = (next_released_ + 1) % released_.size();
  ready.fixes[ready.count++] = {position_world_m, key.emission_time_ns, weight};
}

bool FixQueue::is_released(const Key& key) const {
  return std::find(released_.begin(), released_.end(), key) != released_.end();
}

}  // namespace sonopose::ros2
