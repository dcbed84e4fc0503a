#include <sonopose/ros2/messages/fix_queue.hpp>

#include <algorithm>

namespace sonopose::ros2 {

FixQueue::Ready FixQueue::on(const UltrasonicFix& fix, SteadyTime now, bool fusion_runs) {
  Ready ready;
  const Key key{fix.sequence, fix.emission_time_ns};
  if (is_out(key)) return ready;  // the report was quicker
  if (!fusion_runs) {
    while (waiting_count_ > 0) put_first_out(ready);
    put_out(key, fix.position_world_m, std::nullopt, ready);
    return ready;
  }
  if (waiting_count_ == most_waiting) put_first_out(ready);
  waiting_[waiting_count_++] = {key, fix.position_world_m, now};
  return ready;
}

FixQueue::Ready FixQueue::on(const FixReport& report) {
  Ready ready;
  const Key key{report.sequence, report.emission_time_ns};
  if (is_out(key)) return ready;  // another fusion reported on it already
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_);
  const auto found =
      std::find_if(waiting_.begin(), end, [&key](const Waiting& one) { return one.key == key; });
  if (found != end) {
    for (auto before = found - waiting_.begin(); before > 0; --before) put_first_out(ready);
    std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
              waiting_.begin());
    --waiting_count_;
  }
  put_out(key, report.position_world_m, report.weight, ready);
  return ready;
}

FixQueue::Ready FixQueue::overdue(SteadyTime now) {
  Ready ready;
  while (waiting_count_ > 0 && now - waiting_[0].since > timeout_ns) put_first_out(ready);
  return ready;
}

void FixQueue::put_first_out(Ready& ready) {
  const Waiting first = waiting_[0];
  std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
            waiting_.begin());
  --waiting_count_;
  put_out(first.key, first.position_world_m, std::nullopt, ready);
}

void FixQueue::put_out(const Key& key, const Vector3d& position_world_m, std::optional<double> weight,
                       Ready& ready) {
  out_[next_out_] = key;
  next_out_ = (next_out_ + 1) % out_.size();
  ready.fixes[ready.count++] = {position_world_m, key.emission_time_ns, weight};
}

bool FixQueue::is_out(const Key& key) const {
  return std::find(out_.begin(), out_.end(), key) != out_.end();
}

}  // namespace sonopose::ros2
