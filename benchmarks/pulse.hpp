#pragma once
// A steady clock for sources without a simulator.

#include "clocks/clocks.hpp"
#include <sonopose/idl/sonopose.h>

#include <ctime>

namespace sonopose::benchmarks {

/// Ticks at a fixed rate from its construction.
class Pulse {
public:
  explicit Pulse(double rate_hz)
      : period_ns_(static_cast<TimeNs>(1e9 / rate_hz)), next_(clocks::steady_now()) {}

  /// Sleeps until the next tick.
  void wait() {
    const timespec until{static_cast<time_t>(next_.ns / 1'000'000'000),
                         static_cast<long>(next_.ns % 1'000'000'000)};
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
    next_ += period_ns_;
  }

private:
  TimeNs period_ns_;
  SteadyTime next_;
};

/// Stamps and numbers IMU samples and passes each to `send(const sonopose_ImuSample&)`, forever.
template <class Send>
[[noreturn]] void run_source(double rate_hz, const Send& send) {
  sonopose_ImuSample imu{};
  imu.address = 7;
  Pulse pulse(rate_hz);
  while (true) {
    pulse.wait();
    ++imu.event_sequence;
    imu.sensor_time = imu.bridge_time = clocks::host_now();
    send(imu);
  }
}

}  // namespace sonopose::benchmarks
