#include "observation/own_reports.hpp"

#include "observation/first_reports.hpp"

#include <catch2/catch.hpp>

namespace own_reports_test {

using namespace sonopose;
using namespace sonopose::observation;

SCENARIO("of two fusions, the reports of the one whose poses are received count") {
  GIVEN("a beacon that two fusions serve, and another one") {
    OwnReports own;
    WHEN("the owner of the poses has reported") {
      CHECK(own.accepts(7, "strong", "strong"));
      THEN("the reports of its standby are left out") {
        CHECK_FALSE(own.accepts(7, "weak", "strong"));
        CHECK(own.accepts(7, "strong", "strong"));
      }
      THEN("those on a beacon that the weaker one owns are not") {
        CHECK(own.accepts(8, "weak", "weak"));
        CHECK_FALSE(own.accepts(8, "strong", "weak"));
      }
      AND_WHEN("the standby takes the poses over") {
        CHECK(own.accepts(7, "weak", "weak"));
        THEN("its reports count, and those of the other do not") {
          CHECK_FALSE(own.accepts(7, "strong", "weak"));
          CHECK(own.accepts(7, "weak", "weak"));
        }
      }
    }
    WHEN("the owner is not known, or does not report") {
      THEN("no report is left out") {
        CHECK(own.accepts(7, "weak", ""));
        CHECK(own.accepts(7, "", "strong"));
        CHECK(own.accepts(7, "weak", "a source of poses"));
        CHECK(own.accepts(7, "weak", "a source of poses"));
      }
    }
  }
}

TEST_CASE("Of several reports on a fix, the first one counts") {
  FirstReports reports;
  for (std::uint64_t sequence = 10; sequence < 1000; sequence += 10) {
    FixReport report;
    report.sequence = sequence;
    report.emission_time_ns = static_cast<TimeNs>(sequence) * 1'000'000;
    CHECK(reports.accepts(report));
    CHECK_FALSE(reports.accepts(report));
    report.emission_time_ns += 1'000'000'000;  // of a bridge that has restarted
    CHECK(reports.accepts(report));
  }
}

}  // namespace own_reports_test
