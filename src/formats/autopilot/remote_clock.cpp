#include "autopilot/remote_clock.hpp"

#include <algorithm>
#include <cstdlib>

namespace sonopose::autopilot {

void RemoteClock::on(TimeNs stamp_ns, HostTime arrival, SteadyTime now) {
  constexpr TimeNs step_ns = 500'000'000;
  if (stamp_ns < 0 || stamp_ns >= end_of_time_ns) return;
  const TimeNs offset_ns = saturated_difference(stamp_ns, arrival);
  if (std::abs(saturated_difference(offset_ns, offset_ns_)) > step_ns || now - last_ > lost_after_ns) {
    count_ = 0;
    is_same_clock_ = false;
  }
  last_ = now;
  offsets_ns_[count_++ % window] = offset_ns;
  offset_ns_ = *std::max_element(offsets_ns_.begin(),
                                 offsets_ns_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, window)));
  is_same_clock_ = offset_ns_ >= -(is_same_clock_ ? 2 : 1) * same_clock_ns;
}

std::optional<TimeNs> RemoteClock::at(HostTime time, SteadyTime now) const {
  if (time <= 0 || time >= end_of_time_ns || count_ == 0 || now - last_ > lost_after_ns) return std::nullopt;
  const TimeNs there = time + (is_same_clock_ ? std::max<TimeNs>(offset_ns_, 0) : offset_ns_);
  if (there <= 0) return std::nullopt;  // before the autopilot started
  return there;
}

}  // namespace sonopose::autopilot
