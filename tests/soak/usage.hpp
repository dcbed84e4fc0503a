#pragma once
/// \file
/// What a process uses over time, and whether it grows.

#include <span>
#include <string>
#include <vector>

namespace sonopose::soak {

struct Usage {
  double time_s = 0;  ///< since the start of the run
  double resident_kb = 0;
  int descriptors = 0;
  int threads = 0;
};

/// What the process uses now. Throws std::runtime_error if it does not run.
Usage usage_of(int pid, double time_s);

/// A straight line through the resident memory.
struct Growth {
  double percent_per_hour = 0;  ///< of the mean
  double std_error = 0;         ///< of `percent_per_hour`
};

/// Needs three usages; fewer have no growth.
Growth growth_of(std::span<const Usage> usages);

struct Judgement {
  Growth growth;
  double resident_mb = 0;  ///< mean
  int more_descriptors = 0;
  int more_threads = 0;
  std::vector<std::string> violations;
};

inline constexpr double settling_s = 600;  ///< caches and addresses fill up
inline constexpr double most_percent_per_hour = 1;
inline constexpr double least_judged_s = 3600;  ///< a shorter run cannot show a growth of this size

/// Judges a run by what follows the first ten minutes or, of a short run, the first third. Descriptors and
/// threads must not grow at all, by the least number in the first and the last quarter; what comes and goes
/// does not count. Memory is judged from an hour on.
Judgement judge(const std::string& name, std::span<const Usage> usages);

}  // namespace sonopose::soak
