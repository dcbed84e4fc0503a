#pragma once
/// \file
/// The host's clock without the steps by which it is set.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstdint>

namespace sonopose::bridge {

/// Begins at the host's time and goes on with the steady clock, which the host's follows except when it is
/// set. A beacon's clock is related to this one, and stamps are moved by how far the host's clock is ahead:
/// at once after a large step, and after a small one so slowly that the intervals between them can be
/// integrated.
class StepFreeClock {
public:
  /// From here on a fix, which takes about 70 ms, could seem to arrive before its emission.
  static constexpr TimeNs least_step_ns = 65'000'000;
  static constexpr double most_slew = 4e-3;  ///< of smaller ones, as that of a beacon's clock

  StepFreeClock(HostTime host_ns, SteadyTime steady)
      : start_ns_(host_ns), start_(steady), compared_(steady) {}

  [[nodiscard]] TimeNs at(SteadyTime time) const { return start_ns_ + (time - start_); }

  /// Compares it with the host's clock, which was read between the two times.
  void compare(SteadyTime before, HostTime host_ns, SteadyTime after) {
    constexpr TimeNs most_apart_ns = 500'000;
    if (after - before > most_apart_ns) return;  // the thread was suspended in between
    const TimeNs ahead_ns = saturated_difference(host_ns, at(before + (after - before) / 2));
    const TimeNs change_ns = saturated_difference(ahead_ns, host_ahead_ns_);
    if (change_ns >= least_step_ns || change_ns <= -least_step_ns) {
      host_ahead_ns_ = ahead_ns;
      ++steps_;
    } else {
      const auto most_ns = static_cast<TimeNs>(most_slew * static_cast<double>(before - compared_));
      host_ahead_ns_ += std::clamp(change_ns, -most_ns, most_ns);
    }
    compared_ = before;
  }

  /// How far the host's clock is ahead.
  [[nodiscard]] TimeNs host_ahead_ns() const { return host_ahead_ns_; }

  /// How often the host's clock made a large step.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }

private:
  TimeNs start_ns_;
  SteadyTime start_;
  SteadyTime compared_;
  TimeNs host_ahead_ns_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace sonopose::bridge
