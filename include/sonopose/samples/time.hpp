#pragma once
/// \file
/// Times of two clocks, and durations. The host's clock stamps samples and may be set at any moment; the
/// steady clock measures waiting times. Their types differ, so that one is never passed for the other.

#include <compare>
#include <cstdint>
#include <limits>

namespace sonopose {

/// Nanoseconds: a duration, or a time of the host's clock since the Unix epoch.
using TimeNs = std::int64_t;

/// End of the valid stamps, which begin at 1: the difference of any two fits into TimeNs.
inline constexpr TimeNs end_of_time_ns = TimeNs{1} << 62U;

/// Number of samples in a row that are earlier than one before, after which the sensor's clock has been set
/// back: half a second of a beacon's samples.
inline constexpr int max_backward_samples = 50;

/// A time of the host's clock: nanoseconds since the Unix epoch. A plain number, because estimation
/// integrates it.
using HostTime = TimeNs;

/// A time of the steady clock. It has no epoch: only differences and comparisons are meaningful.
struct SteadyTime {
  std::int64_t ns = 0;

  constexpr auto operator<=>(const SteadyTime&) const =
      default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
  constexpr SteadyTime& operator+=(TimeNs duration_ns) {
    ns += duration_ns;
    return *this;
  }

  /// A time later than any other.
  static constexpr SteadyTime max() { return {std::numeric_limits<std::int64_t>::max()}; }
};

constexpr SteadyTime operator+(SteadyTime time, TimeNs duration_ns) {
  return {time.ns + duration_ns};
}

constexpr SteadyTime operator-(SteadyTime time, TimeNs duration_ns) {
  return {time.ns - duration_ns};
}

/// Duration from `from` to `to` in nanoseconds.
constexpr TimeNs operator-(SteadyTime to, SteadyTime from) {
  return to.ns - from.ns;
}

/// `to` − `from`, limited to the range of TimeNs: stamps from the bus may have any value.
constexpr TimeNs saturated_difference(TimeNs to, TimeNs from) {
  TimeNs difference = 0;
  if (!__builtin_sub_overflow(to, from, &difference)) return difference;
  return to < from ? std::numeric_limits<TimeNs>::min() : std::numeric_limits<TimeNs>::max();
}

/// `time` + `duration`, limited likewise.
constexpr TimeNs saturated_sum(TimeNs time, TimeNs duration) {
  TimeNs sum = 0;
  if (!__builtin_add_overflow(time, duration, &sum)) return sum;
  return duration < 0 ? std::numeric_limits<TimeNs>::min() : std::numeric_limits<TimeNs>::max();
}

/// Seconds from `from` to `to`, limited to 292 years.
constexpr double seconds_between(TimeNs from, TimeNs to) {
  return static_cast<double>(saturated_difference(to, from)) * 1e-9;
}

constexpr double seconds_between(SteadyTime from, SteadyTime to) {
  return seconds_between(from.ns, to.ns);
}

/// Converts seconds to nanoseconds, rounded to nearest.
constexpr TimeNs to_ns(double seconds) {
  return static_cast<TimeNs>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

}  // namespace sonopose
