#pragma once
/// \file
/// How long a busy machine kept this process and its children waiting.

#include "faults/history.hpp"

#include <cstdint>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::faults {

/// Reads from the kernel how long each thread of this process and of its children was ready to run and waited
/// for a processor, and measures by how much its own sleeps are too long. A kernel without
/// /proc/PID/task/TID/schedstat reports nothing.
class StallWatch {
public:
  StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;
  ~StallWatch();

  /// One interval for each stall of a thread; those of several threads overlap.
  [[nodiscard]] std::vector<Interval> stalls() const;

private:
  /// A thread's schedstat.
  struct Task {
    int file = -1;
    std::uint64_t waited_ns = 0;
  };

  void watch(const std::stop_token& stop);
  void find_tasks();
  void sample(SteadyTime now);
  void add(const Interval& stall);

  std::map<std::string, Task> tasks_;  ///< by name of the file
  mutable std::mutex mutex_;
  std::vector<Interval> stalls_;
  std::jthread thread_;
};

/// The same times as disjoint intervals, by time.
std::vector<Interval> merged(std::vector<Interval> intervals);

/// Part of the time from `from` to `until` that is in one of the disjoint intervals.
TimeNs covered_ns(const std::vector<Interval>& disjoint, SteadyTime from, SteadyTime until);

}  // namespace sonopose::faults
