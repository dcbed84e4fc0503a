#include <sonopose/ros2/messages/time.hpp>

namespace sonopose::ros2 {
namespace {

constexpr TimeNs second_ns = 1'000'000'000;

}  // namespace

Time to_ros(TimeNs time_ns) {
  TimeNs seconds = time_ns / second_ns;
  TimeNs rest_ns = time_ns % second_ns;
  if (rest_ns < 0) {
    --seconds;
    rest_ns += second_ns;
  }
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(rest_ns)};
}

std::optional<TimeNs> from_ros(const Time& time) {
  if (time.nanosec >= second_ns) return std::nullopt;
  return time.sec * second_ns + time.nanosec;
}

std::optional<TimeNs> RisingStamp::next(TimeNs time_ns) {
  const TimeNs behind_ns = last_ns_ ? saturated_difference(*last_ns_, time_ns) : -1;
  if (behind_ns >= 0 && behind_ns < new_start_ns) {
    if (behind_ns >= slack_ns_) return std::nullopt;
    time_ns = saturated_sum(*last_ns_, 1);
  }
  last_ns_ = time_ns;
  return time_ns;
}

bool RateThinner::admits(TimeNs stamp_ns) {
  const TimeNs early_ns = saturated_difference(due_ns_, stamp_ns);
  if (early_ns > 0 && early_ns <= period_ns_) return false;
  // After a gap, and after a step of the clock, the period starts with this message.
  const bool in_step = early_ns <= 0 && early_ns > -period_ns_;
  due_ns_ = saturated_sum(in_step ? due_ns_ : stamp_ns, period_ns_);
  return true;
}

}  // namespace sonopose::ros2
