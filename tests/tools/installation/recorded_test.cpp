#include "installation/recorded.hpp"

#include "sim/simulator.hpp"
#include "support/events.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <functional>
#include <string>
#include <vector>

namespace recorded_test {

using namespace sonopose;
using namespace sonopose::installation;
using Catch::Contains;

/// Events of a run, with changed fixes.
std::vector<Event> events_of(const std::string& scenario, std::uint64_t seed,
                             const std::function<void(UltrasonicFix&)>& change = {}) {
  const sim::Run run{.seed = seed, .duration_s = 30};
  auto events = sim::record(sim::drawn(sim::find_scenario(scenario), run), run).events;
  for (auto* fix : test::each<UltrasonicFix>(events)) {
    if (change) change(*fix);
  }
  return events;
}

std::string text_of(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) text += finding.text + ": " + finding.remedy + "\n";
  return text;
}

SCENARIO("A map of a wrong scale is named with its factor") {
  const std::string scenario = GENERATE("walk", "forklift", "drone", "hand_held");
  const double factor = GENERATE(0.8, 1.2);
  CAPTURE(scenario, factor);
  const auto events =
      events_of(scenario, 2101, [factor](UltrasonicFix& fix) { fix.position_world_m *= factor; });
  const std::string text = text_of(findings_in(events, {}, Search::brief));
  CAPTURE(text);
  const std::string begin = "its fixes move ";
  REQUIRE(text.starts_with(begin));
  CHECK(std::stod(text.substr(begin.size())) == Approx(factor).margin(0.05));
  CHECK_THAT(text, Contains("measure a distance between two stationary beacons"));
}

SCENARIO("Positions in feet are named as that") {
  const auto events = events_of("drone", 2121, [](UltrasonicFix& fix) { fix.position_world_m /= 0.3048; });
  CHECK_THAT(text_of(findings_in(events, {}, Search::brief)), Contains("they seem to be in feet"));
}

SCENARIO("A right installation shows no fault, whatever the motion and the noise") {
  std::uint64_t seed = 2131;
  for (const char* const scenario :
       {"walk", "kart", "drone", "outlier_bursts", "imu_scale", "noisy_imu", "bias_field"}) {
    CAPTURE(scenario, seed);
    CHECK(text_of(findings_in(events_of(scenario, seed++), {}, Search::thorough)) == "");
  }
}

SCENARIO("A brief search goes on where a piece shows a fault or fits badly") {
  GIVEN("mirrored fixes") {
    const auto events = events_of("walk", 2151, [](UltrasonicFix& fix) { fix.position_world_m.x() *= -1; });
    THEN("the axis is named, which no single piece without changes shows") {
      CHECK_THAT(text_of(findings_in(events, {}, Search::brief)),
                 Contains("its fixes are mirrored") && Contains("change the sign of x"));
    }
  }
  GIVEN("mirrored fixes, and an accelerometer that reads nothing for a second") {
    auto events = events_of("walk", 2151, [](UltrasonicFix& fix) { fix.position_world_m.x() *= -1; });
    auto samples = test::samples_of<ImuSample>(events);
    const TimeNs from_ns = samples.front().sensor_time_ns + to_ns(5.0);
    for (auto* imu : test::each<ImuSample>(events)) {
      const double time_s = seconds_between(from_ns, imu->sensor_time_ns);
      if (time_s > 0.0 && time_s < 1.0) imu->specific_force_body_mps2.setZero();
    }
    THEN("the mirror is named all the same") {
      CHECK_THAT(text_of(findings_in(events, {}, Search::brief)), Contains("its fixes are mirrored"));
    }
  }
  GIVEN("an accelerometer whose axis x has the wrong sign") {
    auto events = events_of("forklift", 2152);
    for (auto* imu : test::each<ImuSample>(events)) imu->specific_force_body_mps2.x() *= -1;
    THEN("the axis is named") {
      CHECK_THAT(text_of(findings_in(events, {}, Search::brief)),
                 Contains("the wrong sign on the body's axis x"));
    }
  }
}

SCENARIO("An IMU upside down is named with the setting that turns it") {
  auto events = events_of("walk", 2161);
  for (auto* imu : test::each<ImuSample>(events)) {
    for (Vector3d* const vector : {&imu->angular_velocity_body_radps, &imu->specific_force_body_mps2}) {
      *vector = Vector3d(vector->x(), -vector->y(), -vector->z());
    }
  }
  CHECK_THAT(text_of(findings_in(events, {}, Search::brief)), Contains("calibration.axes=+x-y-z"));
  settings::Settings turned;
  settings::set(turned, "calibration.axes", std::string("+x-y-z"));
  CHECK(findings_in(events, turned, Search::brief).empty());
}

SCENARIO("An accelerometer of another scale or sign is no fault of the map or mount") {
  const double factor = GENERATE(0.85, 1.15, -1.0);
  CAPTURE(factor);
  auto events = events_of("forklift", 2165);
  for (auto* imu : test::each<ImuSample>(events)) imu->specific_force_body_mps2 *= factor;
  const std::string text = text_of(findings_in(events, {}, Search::thorough));
  CHECK_THAT(text, !Contains("times as far as the IMU") && !Contains("calibration.axes=+x-y-z"));
  CHECK(text.empty() == (factor > 0));
}

SCENARIO("A wrong mount is found where most of a recording is at rest") {
  const sim::Run run{.seed = 2181, .duration_s = 30};
  auto events = sim::record(sim::drawn(sim::find_scenario("walk"), run), run).events;
  const sim::Run rest{.seed = 2182, .duration_s = 90};
  auto after = sim::record(sim::drawn(sim::find_scenario("rest"), rest), rest).events;
  settings::Settings turned;
  settings::set(turned, "heading.mount_offset_deg", 90.0);
  const TimeNs later_ns = available_at_ns(events.back()) - available_at_ns(after.front()) + to_ns(1);
  for (auto* imu : test::each<ImuSample>(after)) imu->sensor_time_ns += later_ns;
  for (auto* fix : test::each<UltrasonicFix>(after)) {
    fix->emission_time_ns += later_ns;
    fix->received_time_ns += later_ns;
  }
  for (auto* heading : test::each<PairHeading>(after)) {
    heading->emission_time_ns += later_ns;
    heading->received_time_ns += later_ns;
  }
  std::vector<Event> parked = after;
  parked.insert(parked.begin(), events.begin(), events.end());
  CHECK_THAT(text_of(findings_in(parked, turned, Search::brief)), Contains("its mount offset is wrong"));
}

SCENARIO("Headings of a compass that is turned are named, whatever the mount of a pair") {
  const double turned_deg = GENERATE(0.0, 30.0, 90.0);
  CAPTURE(turned_deg);
  settings::Settings settings;
  settings::set(settings, "heading.mount_offset_deg", 45.0);
  auto events = events_of("forklift", 2191);
  for (auto* heading : test::each<PairHeading>(events)) {
    heading->flags |= heading_flag_of_body;
    heading->heading_world_rad += turned_deg * geometry::radians_per_degree;
  }
  const std::string text = text_of(findings_in(events, settings, Search::brief));
  CAPTURE(text);
  const std::string begin = "its headings are ";
  REQUIRE(text.starts_with(begin) == (turned_deg > 0));
  if (text.empty()) return;
  CHECK(std::stod(text.substr(begin.size())) == Approx(turned_deg).margin(3));
  CHECK_THAT(text, Contains("not from north") && !Contains("heading.mount_offset_deg"));
}

SCENARIO("An accelerometer in g says nothing about the installation") {
  auto events = events_of("walk", 2171);
  for (auto* imu : test::each<ImuSample>(events)) imu->specific_force_body_mps2 /= standard_gravity_mps2;
  CHECK(findings_in(events, {}, Search::thorough).empty());
}

}  // namespace recorded_test
