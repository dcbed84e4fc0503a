#pragma once
// Many beacons, and a consumer of the topics that people watch, which only counts their samples.

#include "child.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace sonopose::benchmarks {

struct ManyBeacons {
  std::uint32_t domain = 0;
  std::uint32_t beacons = 50;
  double imu_rate_hz = 100;
};
void add_options(CLI::App& app, ManyBeacons& options);

/// Starts a bridge that simulates them.
Child start_bridge(const ManyBeacons& options, const std::vector<std::string>& more = {});

struct ComparisonOptions : ManyBeacons {
  double round_s = 10;
  int rounds = 5;
};
void add_options(CLI::App& app, ComparisonOptions& options);

/// The chain with a consumer that only counts.
class CountedChain {
public:
  explicit CountedChain(const ComparisonOptions& options);

  /// Prints the processor time of a process that shows the samples next to that of the consumer, and the
  /// median ratio. `viewer` is the screen or page, and `bytes` returns the number of bytes it was sent.
  void compare(pid_t pid, const std::string& viewer, const std::function<std::int64_t()>& bytes) const;

private:
  ComparisonOptions options_;
  std::atomic<std::uint64_t>& count_;
  Child counter_;
  Child fusion_;
  Child bridge_;
};

}  // namespace sonopose::benchmarks
