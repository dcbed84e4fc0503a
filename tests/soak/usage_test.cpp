/// The judge of a long run, with artificial usages.

#include "soak/usage.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <unistd.h>

namespace usage_test {

using namespace sonopose::soak;
using Catch::Contains;

/// Ten samples per minute of a process with 100 MB, 12 descriptors and 5 threads. Its memory grows during the
/// first ten minutes, then by `percent_per_hour`.
std::vector<Usage> run_of(double hours, double percent_per_hour) {
  std::vector<Usage> usages;
  for (double time_s = 0; time_s <= hours * 3600; time_s += 6) {
    const double noise_kb = 40 * std::sin(time_s);  // memory that is allocated and freed again
    const double settled_kb = 102'400 * std::min(1.0, 0.5 + time_s / 1200);
    const double more_kb = 1024 * percent_per_hour * std::max(0.0, time_s - 600) / 3600;
    usages.push_back({time_s, settled_kb + more_kb + noise_kb, 12, 5});
  }
  return usages;
}

SCENARIO("memory may grow by less than a percent an hour, after the first ten minutes") {
  const Judgement good = judge("bridge", run_of(2, 0.9));
  CHECK(good.violations.empty());
  CHECK(good.growth.percent_per_hour == Approx(0.9).margin(0.02));
  CHECK(good.growth.std_error < 0.02);
  CHECK(good.resident_mb == Approx(100).margin(2));
  const Judgement bad = judge("bridge", run_of(2, 1.1));
  REQUIRE(bad.violations.size() == 1);
  CHECK_THAT(bad.violations.front(), Contains("bridge: memory grows by 1."));
}

SCENARIO("a run of minutes measures the growth but does not judge it") {
  const Judgement judgement = judge("bridge", run_of(0.9, 5));
  CHECK(judgement.violations.empty());
  CHECK(judgement.growth.percent_per_hour == Approx(5).margin(0.2));
}

SCENARIO("descriptors and threads must not grow") {
  auto usages = run_of(0.5, 0);
  GIVEN("one more from the middle on") {
    for (std::size_t i = usages.size() / 2; i < usages.size(); ++i) {
      ++usages[i].descriptors;
      ++usages[i].threads;
    }
    THEN("each is a violation") {
      CHECK(judge("relay", usages).violations.size() == 2);
      CHECK(judge("relay", usages).more_descriptors == 1);
    }
  }
  GIVEN("one that comes and goes") {
    for (std::size_t i = 0; i < usages.size(); i += 2) ++usages[i].descriptors;
    THEN("it is none") {
      CHECK(judge("relay", usages).violations.empty());
    }
  }
}

SCENARIO("a run without samples proves nothing") {
  CHECK(judge("relay", {}).violations.size() == 1);
}

SCENARIO("a process that runs has memory, descriptors and threads, and one that has ended is an error") {
  const Usage usage = usage_of(::getpid(), 3);
  CHECK(usage.time_s == 3);
  CHECK(usage.resident_kb > 1000);
  CHECK(usage.descriptors >= 3);
  CHECK(usage.threads >= 1);
  CHECK_THROWS_AS(usage_of(0x7fffffff, 0), std::runtime_error);
}

}  // namespace usage_test
