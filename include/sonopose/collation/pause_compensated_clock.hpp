#pragma once
/// \file
/// A clock that discounts the pauses of its process.

#include <sonopose/samples/time.hpp>

#include <algorithm>

namespace sonopose::collation {

/// Clock for Collator. A pause in which the process did not take events counts little: a missing event may
/// have arrived meanwhile.
class PauseCompensatedClock {
public:
  /// Most that counts of the time between two takes. It is less than the collator's timeout, so that an event
  /// waits for at least one more take.
  static constexpr TimeNs longest_ns = 4'000'000;

  /// Registers that the process takes events at `now`. Returns the time of this clock.
  SteadyTime on_poll(SteadyTime now) {
    time_ += std::min(now - polled_at_, longest_ns);
    polled_at_ = now;
    return time_;
  }

  [[nodiscard]] SteadyTime time() const { return time_; }

private:
  SteadyTime polled_at_;
  SteadyTime time_;
};

}  // namespace sonopose::collation
