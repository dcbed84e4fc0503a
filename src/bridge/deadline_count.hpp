#pragma once
/// \file
/// Counts the deadline periods of one stream that passed without a sample. Cyclone DDS 0.10 counts them for a
/// whole writer only, not per instance.

#include <sonopose/samples/samples.hpp>

#include <cstdint>

namespace sonopose::bridge {

/// Counting begins with the first sample.
class DeadlineCount {
public:
  explicit DeadlineCount(TimeNs period_ns) : period_ns_(period_ns) {}

  void on_sample(SteadyTime now) {
    missed_ = count(now);
    latest_ = now;
    begun_ = true;
  }

  /// Whole periods without a sample, up to `now`.
  [[nodiscard]] std::uint64_t count(SteadyTime now) const {
    if (!begun_ || now <= latest_) return missed_;
    return missed_ + static_cast<std::uint64_t>((now - latest_) / period_ns_);
  }

private:
  TimeNs period_ns_;
  bool begun_ = false;
  SteadyTime latest_;
  std::uint64_t missed_ = 0;
};

}  // namespace sonopose::bridge
