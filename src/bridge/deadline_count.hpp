#pragma once
/// \file
/// Counts the deadline periods of one stream that went by without a sample, where the middleware cannot tell
/// whose they were (Cyclone DDS 0.10 does not name the instance at the writer).

#include <sonopose/samples/samples.hpp>

#include <cstdint>

namespace sonopose::bridge {

/// Times are of the steady clock. Nothing is missed before the first sample.
class DeadlineCount {
public:
  explicit DeadlineCount(TimeNs period_ns) : period_ns_(period_ns) {}

  void on_sample(TimeNs now_ns) {
    missed_ = count(now_ns);
    latest_ns_ = now_ns;
    begun_ = true;
  }

  /// Whole periods without a sample, up to `now_ns`.
  [[nodiscard]] std::uint64_t count(TimeNs now_ns) const {
    if (!begun_ || now_ns <= latest_ns_) return missed_;
    return missed_ + static_cast<std::uint64_t>((now_ns - latest_ns_) / period_ns_);
  }

private:
  TimeNs period_ns_;
  bool begun_ = false;
  TimeNs latest_ns_ = 0;
  std::uint64_t missed_ = 0;
};

}  // namespace sonopose::bridge
