#pragma once
/// \file
/// Returns freed memory to the system.

#include <sonopose/samples/time.hpp>

#include <malloc.h>

namespace sonopose::process {

/// Trims the heap. glibc keeps freed memory between blocks in use. A process whose beacons come and go would
/// seem to grow for hours.
class FreeMemory {
public:
  /// Notes that a large block was freed, such as the state of a beacon.
  void on_freed() { pending_ = true; }

  /// Returns freed memory, at most every ten seconds: meanwhile other threads may wait for memory for some
  /// milliseconds. Call it about once a second.
  void give_back(SteadyTime now) {
    constexpr TimeNs min_interval_ns = 10'000'000'000;
    if (!pending_ || now - given_back_ < min_interval_ns) return;
    ::malloc_trim(0);
    pending_ = false;
    given_back_ = now;
  }

private:
  bool pending_ = false;
  SteadyTime given_back_;
};

}  // namespace sonopose::process
