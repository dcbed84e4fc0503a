#include "logging/increase_log.hpp"

#include <catch2/catch.hpp>

namespace increase_log_test {

using namespace sonopose;
using logging::IncreaseLog;

constexpr TimeNs second_ns = 1'000'000'000;

SCENARIO("a counter that increases for hours gives one line a minute, and their sum is complete") {
  IncreaseLog log;
  const SteadyTime begin{100 * second_ns};
  CHECK_FALSE(log.update(0, begin));
  std::uint64_t count = 0;
  std::uint64_t logged = 0;
  int lines = 0;
  constexpr int seconds = 600;
  for (int s = 1; s <= seconds; ++s) {
    count += 100;
    const auto more = log.update(count, begin + s * second_ns);
    if (s == 1) CHECK(more == 100U);  // the first is immediate
    if (!more) continue;
    ++lines;
    logged += *more;
  }
  CHECK(lines == 10);
  THEN("the rest is given when the process ends") {
    logged += log.finish(count).value_or(0);
    CHECK(logged == count);
    CHECK_FALSE(log.finish(count));
  }
  THEN("or when the minute is over, without a further increase") {
    CHECK(log.update(count, begin + (seconds + 60) * second_ns).value_or(0) + logged == count);
  }
}

}  // namespace increase_log_test
