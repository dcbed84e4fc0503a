/// Rules of silence: it is short while another fusion can serve, and over soon after the last fault.

#include "faults/artificial_history.hpp"

#include <catch2/catch.hpp>

#include <cstdint>

namespace history_silence_test {

using namespace sonopose;
using namespace sonopose::faults;
using namespace sonopose::faults::artificial;
using Catch::Contains;

SCENARIO("silence is at most the lease and a tenth while a warm fusion lives") {
  CHECK(violations_of(takeover(7.105)) == none);
  History history = takeover(7.12);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("no pose for 120.0 ms beside a warm fusion"));
  WHEN("the machine stalled for 10 ms of it") {
    history.stalls = {{at(7.05), at(7.056)}, {at(7.054), at(7.06)}};
    CHECK(violations_of(history) == none);
  }
  WHEN("two of the bridge's samples were lost meanwhile") {
    history = takeover(7.117);
    REQUIRE(violations_of(history).size() == 1);
    std::erase_if(history.imu,
                  [](const Published& imu) { return imu.received > at(7.097) && imu.received < at(7.107); });
    CHECK(violations_of(history) == none);
  }
  WHEN("the other fusion was not warm") {
    history.statuses[1].status.role = FusionRole::warming;
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge's clock was set back by as much") {
    history.episodes.front() = {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = -80 * ms},
                                {at(7.0), at(7.0)}};
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge's clock was set back only after most of it, or was set ahead") {
    const TimeNs amount_ns = GENERATE(-80, 80) * ms;
    history = takeover(7.3);
    history.episodes.front() = {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = amount_ns},
                                {at(7.25), at(7.25)}};
    REQUIRE(violations_of(history).size() == 1);
    CHECK_THAT(violations_of(history).front(), Contains("beside a warm fusion"));
  }
  WHEN("the bridge was silent too") {
    erase_imu(history, 7.01, 7.115);
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge is silent, and an old pose arrives meanwhile") {
    erase_imu(history, 7.01, 7.3);
    erase_poses(history, 7.13, 7.3);
    CHECK(violations_of(history) == none);
  }
}

SCENARIO("lost packets of the bridge excuse short silences, and no change of the owner by themselves") {
  History history = undisturbed();
  history.plan.loss = Loss{Role::bridge, 50};
  GIVEN("a silence that the requests for the lost packets explain") {
    erase_poses(history, 7, 7.15);
    for (FusionReport& report : history.statuses)
      report.status.samples_lost += report.received > at(7) ? 30U : 0U;
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("a longer one") {
    erase_poses(history, 7, 7.2);
    for (FusionReport& report : history.statuses)
      report.status.samples_lost += report.received > at(7) ? 40U : 0U;
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("beside a warm fusion"));
    }
  }
  GIVEN("a weaker fusion that is received for no other reason") {
    pass_on(history, 7);
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("although fusion-300 owns the beacon"));
    }
  }
  GIVEN("one that is received after a gap in the samples") {
    erase_imu(history, 6.95, 7);
    erase_poses(history, 6.95, 7);
    pass_on(history, 7);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
}

SCENARIO("three seconds after the last fault poses flow as before") {
  GIVEN("poses of an engine that initialises, or uses no fixes, for as long") {
    const double ready_s = GENERATE(9.1, 9.3);
    const std::uint32_t flag = GENERATE(std::uint32_t{status_initialising}, std::uint32_t{status_stale});
    History history = undisturbed();
    for (Arrival& pose : history.poses) {
      if (pose.received < at(ready_s)) pose.status = flag;
    }
    const Verdict verdict = HistoryChecker(history).check();
    THEN("it is a violation above three seconds") {
      CHECK(verdict.violations.empty() == (ready_s < 9.2));
      CHECK(seconds_between(0, verdict.recovery_ns) == Approx(ready_s - 6.2).margin(0.01));
    }
  }
  GIVEN("poses that end") {
    History history = undisturbed();
    erase_poses(history, 9.8, 10);
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("not recovered"));
    }
  }
}

}  // namespace history_silence_test
