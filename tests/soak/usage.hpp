#pragma once
/// \file
/// Resource usage of a process over time, and its growth.

#include <span>
#include <string>
#include <vector>

namespace sonopose::soak {

struct Usage {
  double time_s = 0;  ///< time since the start of the run
  double resident_kb = 0;
  int descriptors = 0;
  int threads = 0;
};

/// Current usage of the process. Throws std::runtime_error if it does not run.
Usage usage_of(int pid, double time_s);

/// Slope of a line fitted to the resident memory.
struct Growth {
  double percent_per_hour = 0;  ///< relative to the mean
  double std_error = 0;         ///< standard error of `percent_per_hour`
};

/// Growth of the usages; zero for fewer than three.
Growth growth_of(std::span<const Usage> usages);

struct Judgement {
  Growth growth;
  double resident_mb = 0;  ///< mean
  int more_descriptors = 0;
  int more_threads = 0;
  std::vector<std::string> violations;
};

inline constexpr double settling_s = 600;  ///< time for caches and addresses to fill up
inline constexpr double max_percent_per_hour = 1;
inline constexpr double min_judged_s = 3600;  ///< a shorter run cannot reveal a growth of this size

/// Judges a run after the first ten minutes or, if it is short, the first third. Descriptors and threads must
/// not grow at all. Their smallest numbers in the first and the last quarter count, so temporary ones are
/// ignored. Memory is judged in runs of at least an hour.
Judgement judge(const std::string& name, std::span<const Usage> usages);

}  // namespace sonopose::soak
