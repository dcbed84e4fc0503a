/// Histories as a whole: one that keeps every promise, and those in which nothing is heard.

#include "faults/artificial_history.hpp"

#include <catch2/catch.hpp>

namespace history_checker_test {

using namespace sonopose;
using namespace sonopose::faults;
using namespace sonopose::faults::artificial;
using Catch::Contains;

SCENARIO("a history that keeps every promise has no violations") {
  const Verdict verdict = HistoryChecker(undisturbed()).check();
  CHECK(verdict.violations == none);
  CHECK(verdict.owner_changes == 0);
  CHECK(verdict.missing_counted + verdict.missing_uncounted == 0);
  CHECK(verdict.longest_age_ns == ms / 2);
  CHECK(verdict.longest_silence_ns <= 0);  // each pose came when due
  CHECK(verdict.recovery_ns == 0);
}

SCENARIO("a run without any pose is no good run") {
  CHECK(violations_of(History{}).size() == 1);
}

SCENARIO("a beacon that was fed and never heard is a violation") {
  History history = undisturbed();
  history.beacons = {beacon};
  CHECK(violations_of(history) == none);
  history.beacons.push_back(beacon + 1);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("beacon 8: not recovered"));
}

}  // namespace history_checker_test
