#pragma once
/// \file
/// The time in which a process looked for events.

#include <sonopose/samples/time.hpp>

#include <algorithm>

namespace sonopose::collation {

/// A clock for Collator. A pause in which the process did not look for events counts little: a missing event
/// may have arrived meanwhile, and waits to be taken.
class AttendedTime {
public:
  /// The most that the time between two looks counts: less than the collator's timeout, so that an event
  /// waits for at least one more look.
  static constexpr TimeNs longest_ns = 4'000'000;

  /// The process looks for events at `now`. Returns the time of this clock.
  SteadyTime on_look(SteadyTime now) {
    time_ += std::min(now - looked_, longest_ns);
    looked_ = now;
    return time_;
  }

  [[nodiscard]] SteadyTime time() const { return time_; }

private:
  SteadyTime looked_;
  SteadyTime time_;
};

}  // namespace sonopose::collation
