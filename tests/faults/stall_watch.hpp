#pragma once
/// \file
/// Measures how long a busy machine kept this process and its children waiting.

#include "faults/history.hpp"

#include <cstdint>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::faults {

/// Reads from the kernel how long each thread of this process and its children was runnable but waited for a
/// processor. Also measures the excess of its own sleeps. Reports nothing if the kernel has no
/// /proc/PID/task/TID/schedstat.
class StallWatch {
public:
  StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;
  ~StallWatch();

  /// One interval per stall of a thread; those of several threads overlap.
  [[nodiscard]] std::vector<Interval> stalls() const;

private:
  /// Open schedstat file of a thread.
  struct Task {
    int file = -1;
    std::uint64_t waited_ns = 0;
  };

  void watch(const std::stop_token& stop);
  void find_tasks();
  void sample(SteadyTime now);
  void add(const Interval& stall);

  std::map<std::string, Task> tasks_;  ///< by file name
  mutable std::mutex mutex_;
  std::vector<Interval> stalls_;
  std::jthread thread_;
};

/// Merges intervals into disjoint ones, ordered by time.
std::vector<Interval> merged(std::vector<Interval> intervals);

/// Total time between `from` and `until` covered by the disjoint intervals.
TimeNs covered_ns(const std::vector<Interval>& disjoint, SteadyTime from, SteadyTime until);

}  // namespace sonopose::faults
