#pragma once
/// \file
/// Times as ROS 2 writes them, and stamps that only rise.

#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <optional>

namespace sonopose::ros2 {

/// ROS 2 counts whole seconds in 32 bits, signed, and what is left in nanoseconds: until 2038.
Time to_ros(TimeNs time_ns);

/// Empty where the nanoseconds are a second or more: no clock reads so.
std::optional<TimeNs> from_ros(const Time& time);

/// Consumers drop what is not newer than what they have, and tf2 warns of a stamp that came before. Beacons
/// count milliseconds, so samples that were measured apart may have one stamp.
class RisingStamp {
public:
  /// `slack_ns`: how far behind the last one a sample may be and still count as measured apart.
  explicit RisingStamp(TimeNs slack_ns = 1'000'000) : slack_ns_(slack_ns) {}

  /// The stamp to use for `time_ns`: itself, or, where it is not newer than the last but within the slack, a
  /// nanosecond more than the last. Empty for what is older still: to be left out. Further back than
  /// `new_start_ns` is no late sample but a clock that was set, or a recording that begins anew.
  std::optional<TimeNs> next(TimeNs time_ns);

  static constexpr TimeNs new_start_ns = 1'000'000'000;

private:
  TimeNs slack_ns_;
  std::optional<TimeNs> last_ns_;
};

}  // namespace sonopose::ros2
