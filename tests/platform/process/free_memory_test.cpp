#include "process/free_memory.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <memory>
#include <unistd.h>
#include <vector>

namespace free_memory_test {

using namespace sonopose;

constexpr TimeNs second_ns = 1'000'000'000;

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0;
  std::size_t resident = 0;
  statm >> size >> resident;
  return static_cast<double>(resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))) * 1e-6;
}

/// 40 MB of blocks, one in ten of which is still in use.
std::vector<std::unique_ptr<char[]>> fragments() {
  constexpr std::size_t block_bytes = 4000;
  constexpr std::size_t blocks = 10'000;
  std::vector<std::unique_ptr<char[]>> all;
  for (std::size_t i = 0; i < blocks; ++i) {
    all.push_back(std::make_unique<char[]>(block_bytes));  // zeroed, so the pages are resident
  }
  for (std::size_t i = 0; i < blocks; ++i) {
    if (i % 10 != 0) all[i].reset();
  }
  return all;
}

SCENARIO("freed memory between blocks in use goes back to the system") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return;  // a sanitizer replaces the allocator
#endif
  process::FreeMemory memory;
  constexpr SteadyTime start{100 * second_ns};
  const auto kept = fragments();
  const double before_mb = resident_mb();
  memory.give_back(start);
  CHECK(resident_mb() > before_mb - 5);  // no freed memory was reported
  memory.on_freed();
  memory.give_back(start);
  CHECK(resident_mb() < before_mb - 20);
  WHEN("more is freed soon after") {
    const auto more = fragments();
    const double more_mb = resident_mb();
    memory.on_freed();
    memory.give_back(start + 5 * second_ns);
    CHECK(resident_mb() > more_mb - 5);
    THEN("it goes back ten seconds after the last time") {
      memory.give_back(start + 10 * second_ns);
      CHECK(resident_mb() < more_mb - 20);
    }
  }
}

}  // namespace free_memory_test
