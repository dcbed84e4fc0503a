#pragma once
// Real-time scheduling of this process, the consumer, during a round.

#include "process/realtime.hpp"

#include <sched.h>
#include <sys/mman.h>

namespace sonopose::benchmarks {

/// Applies real-time settings. Construct it after the consumer's threads; the destructor restores the main
/// thread and the memory.
class OwnRealtime {
public:
  OwnRealtime() : realtime_(process::apply_realtime(50)) {}
  OwnRealtime(const OwnRealtime&) = delete;
  OwnRealtime& operator=(const OwnRealtime&) = delete;
  ~OwnRealtime() {
    const sched_param usual{};
    ::sched_setscheduler(0, SCHED_OTHER, &usual);
    ::munlockall();
  }

private:
  process::Realtime realtime_;
};

}  // namespace sonopose::benchmarks
