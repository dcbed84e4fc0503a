/// Rule of accounting: every missing number is counted.

#include "faults/artificial_history.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <vector>

namespace history_numbers_test {

using namespace sonopose;
using namespace sonopose::faults;
using namespace sonopose::faults::artificial;
using Catch::Contains;

SCENARIO("every missing number is counted") {
  GIVEN("three samples without a pose") {
    History history = undisturbed();
    erase_poses(history, 8, 8.015);
    WHEN("nobody counts them") {
      const Verdict verdict = HistoryChecker(history).check();
      REQUIRE(verdict.violations.size() == 1);
      CHECK_THAT(verdict.violations.front(), Contains("3 samples have no pose of fusion-300, and 3 of them"));
      CHECK(verdict.missing_uncounted == 3);
    }
    WHEN("the fusion counts two of them as lost and one as invalid") {
      history.statuses[2].status.events_lost = 2;
      history.statuses[2].status.samples_invalid = 1;
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.violations == none);
      CHECK(verdict.missing_counted == 3);
    }
    WHEN("it had counted them before") {
      history.statuses[0].status.events_lost = history.statuses[2].status.events_lost = 3;
      CHECK(violations_of(history).size() == 1);
    }
    WHEN("another fusion counts them") {
      history.statuses[3].status.events_lost = 3;
      CHECK(violations_of(history).size() == 1);
    }
    WHEN("the consumer's reader counts them") {
      history.consumer_lost = 3;
      CHECK(violations_of(history) == none);
    }
    WHEN("the consumer's reader counts them, and another fusion's poses are missing too") {
      pass_on(history, 9);
      erase_poses(history, 9.2, 9.215);
      history.losses.push_back({at(9), process_of(300)});
      history.consumer_lost = GENERATE(3U, 6U);
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.missing_uncounted == 6 - history.consumer_lost);
    }
    WHEN("a second beacon misses three too, and the transport counts for the process") {
      const std::uint64_t lost = GENERATE(3U, 6U);
      const BeaconAddress second = beacon + 1;
      for (Published imu : std::vector(history.imu)) {
        imu.address = second;
        history.imu.push_back(imu);
      }
      for (Arrival pose : std::vector(history.poses)) {
        pose.address = second;
        history.poses.push_back(pose);
      }
      for (FusionReport report : std::vector(history.statuses)) {
        report.status.address = second;
        history.statuses.push_back(report);
      }
      for (FusionReport& report : history.statuses) {
        if (report.received > at(9) && report.process == process_of(300)) report.status.samples_lost = lost;
      }
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.missing_counted == lost);
      CHECK(verdict.missing_uncounted == 6 - lost);
      CHECK(verdict.violations.empty() == (lost == 6));
    }
  }
  GIVEN("a fusion that is stopped between the judgement of a pose and its writing") {
    History history = undisturbed();
    history.episodes.back() = {{.fault = Fault::stop, .target = Role::first_fusion}, {at(7.9999), at(8.05)}};
    for (Arrival& pose : history.poses) {
      if (pose.received > at(7.995) && pose.received < at(8.05)) pose.received = at(8.05);
    }
    THEN("that pose is not missing") {
      CHECK(HistoryChecker(history).check().missing_uncounted == 0);
    }
  }
}

}  // namespace history_numbers_test
