#include "ros2/relay/fix_queue.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace fix_queue_test {

using namespace sonopose;
using namespace sonopose::ros2;
using namespace sonopose::ros2::relay;

constexpr TimeNs ms = 1'000'000;

UltrasonicFix fix_number(std::uint64_t sequence) {
  UltrasonicFix fix;
  fix.sequence = sequence;
  fix.emission_time_ns = static_cast<TimeNs>(sequence) * 100 * ms;
  fix.position_world_m = {static_cast<double>(sequence), 0, 0};
  return fix;
}

FixReport report_on(std::uint64_t sequence, double weight) {
  FixReport report;
  report.sequence = sequence;
  report.emission_time_ns = static_cast<TimeNs>(sequence) * 100 * ms;
  report.position_world_m = {static_cast<double>(sequence), 0, 0};
  report.weight = weight;
  return report;
}

/// Number and weight of each fix; −1 if it has no weight.
std::vector<std::pair<int, double>> of(const FixQueue::Ready& ready) {
  std::vector<std::pair<int, double>> result;
  for (const ReadyFix& fix : ready) {
    CHECK(fix.emission_time_ns == static_cast<TimeNs>(fix.position_world_m.x()) * 100 * ms);
    result.emplace_back(static_cast<int>(fix.position_world_m.x()), fix.weight.value_or(-1));
  }
  return result;
}

using List = std::vector<std::pair<int, double>>;

SCENARIO("each fix is released once, with the weight of the fusion") {
  GIVEN("a fusion that runs, and a fix") {
    FixQueue queue;
    CHECK(of(queue.on(fix_number(1), SteadyTime{0}, true)).empty());
    WHEN("the fusion reports on it") {
      THEN("it is released with its weight") {
        CHECK(of(queue.on(report_on(1, 0.5))) == List{{1, 0.5}});
      }
    }
    WHEN("two fusions report on it, one of them on standby") {
      CHECK(of(queue.on(report_on(1, 0.5))).size() == 1);
      THEN("it is released once") {
        CHECK(of(queue.on(report_on(1, 0.7))).empty());
      }
    }
    WHEN("there is no report") {
      THEN("it is released once, after 0.1 s") {
        CHECK(of(queue.overdue(SteadyTime{100 * ms})).empty());
        CHECK(of(queue.overdue(SteadyTime{101 * ms})) == List{{1, -1}});
        CHECK(of(queue.on(report_on(1, 0.5))).empty());
      }
    }
    WHEN("the report on the next fix arrives first") {
      CHECK(of(queue.on(fix_number(2), SteadyTime{50 * ms}, true)).empty());
      THEN("both are released in order") {
        CHECK(of(queue.on(report_on(2, 0.9))) == List{{1, -1}, {2, 0.9}});
      }
    }
    WHEN("the fusion has stopped") {
      THEN("no fix waits") {
        CHECK(of(queue.on(fix_number(2), SteadyTime{50 * ms}, false)) == List{{1, -1}, {2, -1}});
      }
    }
    WHEN("the queue is full") {
      for (std::uint64_t i = 2; i <= FixQueue::max_waiting; ++i) {
        CHECK(of(queue.on(fix_number(i), SteadyTime{0}, true)).empty());
      }
      THEN("the oldest fix is released") {
        CHECK(of(queue.on(fix_number(FixQueue::max_waiting + 1), SteadyTime{0}, true)) == List{{1, -1}});
      }
    }
  }
  GIVEN("a report that arrives before its fix") {
    FixQueue queue;
    CHECK(of(queue.on(report_on(4, 0.25))) == List{{4, 0.25}});
    THEN("the fix is not released again") {
      CHECK(of(queue.on(fix_number(4), SteadyTime{0}, true)).empty());
    }
  }
}

SCENARIO("a fix keeps its own covariance") {
  FixQueue queue;
  UltrasonicFix fix = fix_number(1);
  fix.covariance_world_m2 = Covariance<3>::from_diagonal({0.01, 0.04, 0.09});
  WHEN("it waits for its report") {
    CHECK(queue.on(fix, SteadyTime{}, true).count == 0);
    const FixQueue::Ready ready = queue.on(report_on(1, 0.5));
    THEN("it has both") {
      REQUIRE(ready.count == 1);
      CHECK(ready.fixes[0].covariance_world_m2 == fix.covariance_world_m2);
      CHECK(ready.fixes[0].weight == 0.5);
    }
  }
  WHEN("no fusion runs") {
    const FixQueue::Ready ready = queue.on(fix, SteadyTime{}, false);
    THEN("it has it too") {
      REQUIRE(ready.count == 1);
      CHECK(ready.fixes[0].covariance_world_m2 == fix.covariance_world_m2);
    }
  }
}

}  // namespace fix_queue_test
