/// Detection of more runnable threads than processors.

#include "faults/stall_watch.hpp"

#include "clocks/clocks.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <thread>

namespace stall_watch_test {

using namespace sonopose;
using namespace sonopose::faults;

SCENARIO("threads that wait for a processor are stalls") {
  if (!std::filesystem::exists("/proc/self/schedstat")) {
    std::cout << "skipped: the kernel does not say how long threads wait (CONFIG_SCHED_INFO)\n";
    return;
  }
  const StallWatch watch;
  const SteadyTime begin = clocks::steady_now();
  {
    std::vector<std::jthread> busy;
    for (unsigned i = 0; i < 3 * std::max(1U, std::thread::hardware_concurrency()); ++i) {
      busy.emplace_back([begin] {
        while (clocks::steady_now() - begin < 300'000'000) {
        }
      });
    }
  }
  const auto stalls = watch.stalls();
  REQUIRE(!stalls.empty());
  for (const Interval& stall : stalls) CHECK(stall.until > stall.from);
}

}  // namespace stall_watch_test
