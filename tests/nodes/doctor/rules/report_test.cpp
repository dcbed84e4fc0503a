#include "doctor/rules/report.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace report_test {

using namespace sonopose::doctor::rules;
using Catch::Contains;
using Catch::EndsWith;

/// Findings on beacons from 7 on: each is well, and a single one, which is a note.
std::vector<Finding> beacons(int count) {
  std::vector<Finding> findings{{Severity::ok, "bus", "domain 3", ""}};
  for (int address = 7; address < 7 + count; ++address) {
    const std::string subject = "beacon " + std::to_string(address);
    findings.push_back({Severity::ok, subject, "IMU 100.0 Hz", ""});
    findings.push_back({Severity::note, subject, "no pair headings received", ""});
  }
  return findings;
}

std::ptrdiff_t lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

SCENARIO("a report has one line for all that is well, and one for each problem") {
  GIVEN("one healthy beacon") {
    THEN("the line has its rates") {
      CHECK(report_of(beacons(1)) ==
            "ok       bus: domain 3; beacon 7: IMU 100.0 Hz\n"
            "note     beacon 7: no pair headings received\n"
            "no problems found\n");
    }
  }
  GIVEN("twenty healthy beacons") {
    const auto findings = beacons(20);
    THEN("they are one line, and their equal notes another") {
      CHECK(report_of(findings) ==
            "ok       bus: domain 3; 20 beacons (details: --verbose)\n"
            "note     20 beacons: no pair headings received\n"
            "no problems found\n");
    }
    THEN("the details are a line each") {
      const std::string text = report_of(findings, true);
      CHECK(lines_of(text) == 1 + 20 + 20 + 1);
      CHECK_THAT(text, Contains("ok       beacon 26: IMU 100.0 Hz\n"));
    }
  }
  GIVEN("twenty beacons, two of which have problems") {
    auto findings = beacons(20);
    for (const std::string subject : {"beacon 9", "beacon 12"}) {
      findings.push_back({Severity::warning, subject, "no fixes received", "wake it up"});
    }
    findings.push_back({Severity::error, "beacon 9", "two bridges publish it", "stop one"});
    THEN("each problem is a line with its remedy, and the two beacons are not well") {
      const std::string text = report_of(findings);
      CHECK_THAT(text, Contains("; 18 beacons ") && Contains("warning  beacon 9: no fixes received\n") &&
                           Contains("warning  beacon 12: no fixes received\n") &&
                           EndsWith("error    beacon 9: two bridges publish it\n         → stop one\n"
                                    "1 error, 2 warnings\n"));
      CHECK(lines_of(text) == 1 + 1 + 3 * 2 + 1);
    }
  }
  GIVEN("two beacons with problems") {
    auto findings = beacons(2);
    findings.push_back({Severity::warning, "beacon 7", "no fixes received", ""});
    findings.push_back({Severity::warning, "beacon 8", "no fixes received", ""});
    THEN("none is well") {
      CHECK_THAT(report_of(findings), Catch::StartsWith("ok       bus: domain 3\n"));
    }
  }
}

}  // namespace report_test
