/// No false alarms: the doctor on healthy simulated and recorded beacons.

#include "doctor/replayed.hpp"
#include "recording/log_folder.hpp"
#include "support/recordings.hpp"

#include <catch2/catch.hpp>

#include <iostream>
#include <random>

namespace scenarios_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::test;

constexpr std::array healthy_scenarios{"rest", "walk",  "circle", "forklift",   "kart",
                                       "spin", "drone", "jitter", "packet_loss"};

TEST_CASE("The doctor finds nothing wrong in healthy scenarios") {
  std::mt19937 random(77);
  std::uniform_real_distribution<double> begins_s(6, 18);
  for (const char* const scenario : healthy_scenarios) {
    for (std::uint64_t seed = 2001; seed < 2003; ++seed) {
      const auto events = events_of(scenario, seed, 30);
      for (const double window_s : {3.0, 8.0}) {
        const Look look{begins_s(random), window_s};
        CAPTURE(scenario, seed, look.begin_s, look.window_s);
        CHECK(problems_of(observed(events, {}, look)) == "");
      }
    }
  }
}

TEST_CASE("The doctor finds nothing wrong in the recorded flights") {
  for (const char* const flight : {"drone_a", "drone_b"}) {
    const auto folder = sonopose::test::beacon_recordings(flight);
    if (!sonopose::test::is_here(folder)) continue;
    const auto events = recording::read_sensor_log(folder).events;
    for (const Look& look : {Look{6, 3}, Look{12, 8}, Look{6, 40}}) {
      CAPTURE(flight, look.begin_s, look.window_s);
      CHECK(problems_of(observed(events, {}, look)) == "");
    }
  }
}

TEST_CASE("The doctor finds the mount of the recorded car") {
  const auto folder = sonopose::test::beacon_recordings("car");
  if (!sonopose::test::is_here(folder)) return;
  const auto events = recording::read_sensor_log(folder).events;
  CHECK_THAT(problems_of(observed(events, {}, {45, 30})), Catch::Contains("mount offset is wrong by about"));
  settings::Settings right;
  right.heading.mount_offset_deg = 86;
  CHECK_THAT(problems_of(observed(events, right, {45, 30})), !Catch::Contains("mount offset is wrong"));
}

/// Prints what is found in every scenario. It checks nothing that the tests above do not.
TEST_CASE("Findings in every scenario", "[.survey]") {
  std::mt19937 random(78);
  std::uniform_real_distribution<double> begins_s(6, 40);
  const auto survey = [&](const sim::Scenario& scenario) {
    for (std::uint64_t seed = 2101; seed < 2107; ++seed) {
      const Look look{begins_s(random), seed % 2 == 0 ? 8.0 : 16.0};
      std::cout << scenario.name << ' ' << seed << " from " << look.begin_s << " s for " << look.window_s
                << " s:\n"
                << problems_of(observed(events_of(std::string(scenario.name), seed, 60), {}, look));
    }
  };
  for (const sim::Scenario& scenario : sim::scenarios()) survey(scenario);
  for (const sim::Scenario& scenario : sim::harder_scenarios()) survey(scenario);
}

}  // namespace scenarios_test
