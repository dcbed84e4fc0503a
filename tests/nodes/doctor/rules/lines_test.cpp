#include "doctor/rules/healthy_system.hpp"

#include <catch2/catch.hpp>

namespace lines_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::rules::test;
using Catch::Contains;

/// A bridge with one line and no beacon.
std::vector<Finding> findings_of(LineState state, const std::string& text) {
  Observations observations = healthy();
  observations.beacons.clear();
  LineStatus line;
  line.name = "/dev/ttyACM0";
  line.state = state;
  line.text = text;
  observations.lines = {line};
  return diagnose(observations);
}

TEST_CASE("A line without frames is a problem, also before any beacon is known") {
  const std::string noise = "5230 bytes without a valid frame: check --baud";
  CHECK(found(findings_of(LineState::no_frames, noise), noise).severity == Severity::error);
  CHECK(found(findings_of(LineState::no_frames, noise), noise).subject == "line /dev/ttyACM0");
  CHECK(found(findings_of(LineState::silent, "no bytes for 9 s"), "no bytes").severity == Severity::warning);
  const Finding absent = found(findings_of(LineState::waiting, "No such file or directory"), "No such file");
  CHECK(absent.severity == Severity::warning);
  CHECK_THAT(absent.remedy, Contains("--device"));
  const Finding refused = found(findings_of(LineState::failed, "Permission denied"), "Permission denied");
  CHECK(refused.severity == Severity::error);
  CHECK_THAT(refused.remedy, !Contains("dialout"));  // `text` already names the device's group
}

TEST_CASE("A line with frames is no problem") {
  CHECK_FALSE(has_problems(findings_of(LineState::open, "")));
}

}  // namespace lines_test
