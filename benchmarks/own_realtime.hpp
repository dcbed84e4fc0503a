#pragma once
// Real time for the benchmark's own process, which is the consumer, for as long as a round lasts.

#include "process/realtime.hpp"

#include <sched.h>
#include <sys/mman.h>

namespace sonopose::benchmarks {

/// To be made when the consumer's threads exist; puts main thread and memory back as they were.
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
