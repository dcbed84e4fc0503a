#include "ros2/relay/odometry_buffer.hpp"

#include <algorithm>

namespace sonopose::ros2::relay {

void OdometryBuffer::add(TimeNs time_ns, const Transform& base_in_odom) {
  constexpr TimeNs max_step_back_ns = 1'000'000'000;
  if (count_ > 0 && time_ns <= from_latest(0).time_ns) {
    if (saturated_difference(from_latest(0).time_ns, time_ns) < max_step_back_ns) return;
    count_ = 0;
  }
  entries_[next_] = {time_ns, base_in_odom};
  next_ = (next_ + 1) % entries_.size();
  count_ = std::min(count_ + 1, entries_.size());
}

std::optional<Transform> OdometryBuffer::at(TimeNs time_ns) const {
  if (count_ == 0) return std::nullopt;
  if (time_ns >= from_latest(0).time_ns) {
    if (saturated_difference(time_ns, from_latest(0).time_ns) > hold_ns) return std::nullopt;
    return from_latest(0).base_in_odom;
  }
  for (std::size_t back = 1; back < count_; ++back) {
    const Entry& before = from_latest(back);
    if (before.time_ns > time_ns) continue;
    const Entry& after = from_latest(back - 1);
    const double fraction =
        seconds_between(before.time_ns, time_ns) / seconds_between(before.time_ns, after.time_ns);
    const Transform& a = before.base_in_odom;
    const Transform& b = after.base_in_odom;
    return Transform{a.translation_m + fraction * (b.translation_m - a.translation_m),
                     a.rotation.slerp(fraction, b.rotation)};
  }
  return std::nullopt;
}

}  // namespace sonopose::ros2::relay
