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
  if (last_ns_ && time_ns <= *last_ns_ && time_ns > *last_ns_ - new_start_ns) {
    if (time_ns <= *last_ns_ - slack_ns_) return std::nullopt;
    time_ns = *last_ns_ + 1;
  }
  last_ns_ = time_ns;
  return time_ns;
}

}  // namespace sonopose::ros2
