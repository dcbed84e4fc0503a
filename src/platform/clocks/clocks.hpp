#pragma once
/// \file
/// Reads the host's two clocks and the processor time.

#include <sonopose/samples/time.hpp>

#include <chrono>
#include <ctime>

namespace sonopose::clocks {

/// Current time of the clock that stamps samples. It can be set, also backwards.
inline HostTime host_now() {
  using std::chrono::duration_cast;
  return duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Current time of the monotonic clock, for waits and timeouts.
inline SteadyTime steady_now() {
  using std::chrono::duration_cast;
  return {
      duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count()};
}

inline TimeNs thread_time_ns() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return TimeNs{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace sonopose::clocks
