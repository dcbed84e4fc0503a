#pragma once
/// \file
/// The host's clock without its steps.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>

namespace sonopose::bridge {

/// Starts at the host's time and follows the steady clock, as the host's clock does unless it is set. A
/// beacon's clock is related to this one. Stamps are then moved by the lead of the host's clock: immediately
/// after a large step, but slowly after a small one, so that intervals can still be integrated.
class StepFreeClock {
public:
  /// Smallest large step. A fix takes about 70 ms, so it could then seem to arrive before its emission.
  static constexpr TimeNs min_step_ns = 65'000'000;
  static constexpr double max_slew = 4e-3;  ///< rate of correction after small steps, as for a beacon's clock

  StepFreeClock(HostTime host_ns, SteadyTime steady)
      : start_ns_(host_ns), start_(steady), compared_(steady) {}

  [[nodiscard]] TimeNs at(SteadyTime time) const { return start_ns_ + (time - start_); }

  /// Compares this clock with the host's, which was read between the two times.
  void compare(SteadyTime before, HostTime host_ns, SteadyTime after) {
    constexpr TimeNs max_apart_ns = 500'000;
    if (after - before > max_apart_ns) return;  // the thread was suspended in between
    const TimeNs ahead_ns = saturated_difference(host_ns, at(before + (after - before) / 2));
    const TimeNs change_ns = saturated_difference(ahead_ns, host_ahead_ns_);
    if (change_ns >= min_step_ns || change_ns <= -min_step_ns) {
      host_ahead_ns_ = ahead_ns;
      ++steps_;
    } else {
      const auto max_ns = static_cast<TimeNs>(max_slew * static_cast<double>(before - compared_));
      host_ahead_ns_ += std::clamp(change_ns, -max_ns, max_ns);
    }
    compared_ = before;
  }

  /// Amount by which the host's clock is ahead.
  [[nodiscard]] TimeNs host_ahead_ns() const { return host_ahead_ns_; }

  /// Number of large steps of the host's clock.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }

private:
  TimeNs start_ns_;
  SteadyTime start_;
  SteadyTime compared_;
  TimeNs host_ahead_ns_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace sonopose::bridge
