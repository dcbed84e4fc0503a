#pragma once
/// \file
/// Counts deadline periods of one stream without a sample. Cyclone DDS 0.10 counts them only for a whole
/// writer, not per instance.

#include <sonopose/samples/samples.hpp>

#include <cstdint>

namespace sonopose::publication {

/// Missed periods of one stream, from its first sample on.
class DeadlineCount {
public:
  explicit DeadlineCount(TimeNs period_ns) : period_ns_(period_ns) {}

  void on_sample(SteadyTime now) {
    missed_ = count(now);
    latest_ = now;
    begun_ = true;
  }

  /// Number of whole periods without a sample, up to `now`.
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

}  // namespace sonopose::publication
