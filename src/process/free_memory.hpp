#pragma once
/// \file
/// Gives freed memory back to the system.

#include <sonopose/samples/time.hpp>

#include <malloc.h>

namespace sonopose::process {

/// glibc keeps what was freed between blocks that are still in use. A process whose beacons come and go would
/// seem to grow for hours.
class FreeMemory {
public:
  /// Something large was freed, such as what belonged to a beacon.
  void on_freed() { pending_ = true; }

  /// Gives back what was freed, at most every ten seconds: meanwhile other threads may wait for memory for
  /// some milliseconds. Call it about once a second.
  void give_back(SteadyTime now) {
    constexpr TimeNs least_interval_ns = 10'000'000'000;
    if (!pending_ || now - given_back_ < least_interval_ns) return;
    ::malloc_trim(0);
    pending_ = false;
    given_back_ = now;
  }

private:
  bool pending_ = false;
  SteadyTime given_back_;
};

}  // namespace sonopose::process
