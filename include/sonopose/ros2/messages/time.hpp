#pragma once
/// \file
/// Times in ROS 2 messages, and strictly increasing stamps.

#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <optional>

namespace sonopose::ros2 {

/// Converts to ROS 2's seconds (signed, 32 bits) and nanoseconds, valid until 2038.
Time to_ros(TimeNs time_ns);

/// Converts from ROS 2; empty for an invalid time with 10⁹ nanoseconds or more.
std::optional<TimeNs> from_ros(const Time& time);

/// Generates strictly increasing stamps. Consumers drop messages that are not newer than the previous one,
/// and tf2 warns about repeated stamps. Beacons count milliseconds, so different samples may have the same
/// time.
class RisingStamp {
public:
  /// `slack_ns`: a sample older than the last one by less than this gets the next stamp.
  explicit RisingStamp(TimeNs slack_ns = 1'000'000) : slack_ns_(slack_ns) {}

  /// Stamp for `time_ns`: `time_ns` if it is newer than the last stamp, or, within the slack, the last stamp
  /// plus one nanosecond. Empty for an older sample, which is to be dropped. A step back by `new_start_ns` or
  /// more is accepted: the clock was set, or a recording restarted.
  std::optional<TimeNs> next(TimeNs time_ns);

  static constexpr TimeNs new_start_ns = 1'000'000'000;

private:
  TimeNs slack_ns_;
  std::optional<TimeNs> last_ns_;
};

/// Thins a stream to an average rate.
class RateThinner {
public:
  /// `rate_hz`: 0 means no limit.
  explicit RateThinner(double rate_hz) : period_ns_(rate_hz > 0 ? to_ns(std::min(1 / rate_hz, 1e6)) : 0) {}

  /// True if the message with this stamp is to be published.
  bool admits(TimeNs stamp_ns);

private:
  TimeNs period_ns_;
  TimeNs due_ns_ = 0;
};

}  // namespace sonopose::ros2
