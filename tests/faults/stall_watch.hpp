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

/// Watches the threads of this process and of its children by what the kernel reports: how long each was
/// ready to run and waited for a processor. A kernel without /proc/PID/task/TID/schedstat reports nothing.
/// Also by how much its own sleeps are too long.
class StallWatch {
public:
  StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;
  ~StallWatch();

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

}  // namespace sonopose::faults
