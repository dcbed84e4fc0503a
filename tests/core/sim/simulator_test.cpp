#include "sim/simulator.hpp"

#include "support/events.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace simulator_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

std::vector<Step> all_steps(const SensorSettings& settings, const Run& run, const char* scenario = "walk") {
  Simulator simulator(find_scenario(scenario), settings, run);
  std::vector<Step> steps;
  while (auto step = simulator.next()) steps.push_back(*step);
  return steps;
}

std::vector<Event> events_of(const std::vector<Step>& steps) {
  std::vector<Event> events;
  events.reserve(steps.size());
  for (const Step& step : steps) events.push_back(step.event);
  return events;
}

SCENARIO("events come in the order in which a bridge gets them") {
  GIVEN("20 s of a noisy walk, its fixes' delay longer than their period") {
    SensorSettings settings;
    settings.fix_delay_s = 0.15;
    settings.fix_delay_jitter_s = 0.05;  // fixes may overtake each other
    const auto steps = all_steps(settings, {.start_time_ns = start_ns, .address = 9, .duration_s = 20.0});
    THEN("they are ordered by availability, at a tie IMU, fix, heading; numbered from 1; of one address") {
      REQUIRE(steps.size() > 2000);
      for (std::size_t i = 0; i < steps.size(); ++i) {
        CHECK(sequence_of(steps[i].event) == i + 1);
        CHECK(address_of(steps[i].event) == 9);
        if (i == 0) continue;
        const TimeNs before = available_at_ns(steps[i - 1].event);
        const TimeNs now = available_at_ns(steps[i].event);
        REQUIRE(before <= now);
        if (before == now) CHECK(steps[i - 1].event.index() < steps[i].event.index());
      }
    }
    THEN("each IMU sample brings its truth, nothing else does") {
      for (const Step& step : steps) {
        const auto* imu = std::get_if<ImuSample>(&step.event);
        REQUIRE((imu != nullptr) == step.truth.has_value());
        if (imu != nullptr) CHECK(step.truth->time_ns == imu->sensor_time_ns);
      }
    }
  }
  GIVEN("a run that ends while a fix is under way") {
    SensorSettings settings = SensorSettings::ideal();
    settings.fix_delay_s = 0.5;
    const auto steps = all_steps(settings, {.start_time_ns = start_ns, .duration_s = 1.0});
    THEN("what would be received after the end does not come") {
      CHECK(available_at_ns(steps.back().event) < start_ns + 1'000'000'000);
      int fixes = 0;
      for (const Step& step : steps) fixes += std::holds_alternative<UltrasonicFix>(step.event) ? 1 : 0;
      CHECK(fixes >= 5);  // fixes emitted in the first half second
      CHECK(fixes <= 6);
    }
  }
}

SCENARIO("a heading is the direction of the pair's axis in the map, also of a tilted body") {
  GIVEN("a perfect pair at 45 degrees to the body, which is pitched") {
    constexpr double pitch_rad = 0.5;
    SensorSettings settings = SensorSettings::ideal();
    settings.pair_mount_offset_rad = 0.25 * std::numbers::pi;
    Motion motion;
    motion.q_body_to_world = geometry::rotation_by(Vector3d(0.0, pitch_rad, 0.0));
    WHEN("it is measured") {
      const PairHeading heading = UltrasonicModel(settings, Random(1)).measure_heading(motion);
      THEN("the part along body X is shortened in the horizontal plane") {
        CHECK(heading.heading_world_rad == Approx(std::atan2(1.0, std::cos(pitch_rad))));
      }
    }
  }
}

SCENARIO("a fix has the position at emission, and arrives later") {
  GIVEN("a perfect kart with the pair mounted across, 12 Hz and 68 ms") {
    SensorSettings settings = SensorSettings::ideal();
    settings.pair_mount_offset_rad = 1.5;
    const Scenario& circle = find_scenario("circle");
    int fixes = 0;
    TimeNs last_emission_ns = 0;
    for (const Step& step : all_steps(settings, {.start_time_ns = start_ns, .duration_s = 20.0}, "circle")) {
      if (const auto* fix = std::get_if<UltrasonicFix>(&step.event)) {
        const Motion then = circle.motion(seconds_between(start_ns, fix->emission_time_ns));
        CHECK(fix->position_world_m == then.position_world_m);
        CHECK(fix->received_time_ns - fix->emission_time_ns == 68'000'000);
        CHECK(fix->measured_delay_s == 0.068);
        if (fixes > 0) CHECK(seconds_between(last_emission_ns, fix->emission_time_ns) == Approx(1.0 / 12.0));
        last_emission_ns = fix->emission_time_ns;
        ++fixes;
      } else if (const auto* heading = std::get_if<PairHeading>(&step.event)) {
        const Motion then = circle.motion(seconds_between(start_ns, heading->emission_time_ns));
        const double body_yaw = heading->heading_world_rad - 1.5;
        CHECK(heading->valid);
        CHECK(std::abs(geometry::wrap_angle(body_yaw - geometry::yaw_of(then.q_body_to_world))) < 1e-9);
        CHECK(heading->emission_time_ns == last_emission_ns);
      }
    }
    CHECK(fixes >= 238);
    CHECK(fixes <= 240);
  }
}

SCENARIO("a run is reproducible") {
  const Run run{.seed = 11, .start_time_ns = start_ns, .address = 7, .duration_s = 8.0};
  const auto events = events_of(all_steps(SensorSettings{}, run));
  THEN("the same seed gives the same bits") {
    CHECK(events == events_of(all_steps(SensorSettings{}, run)));
  }
  THEN("another seed, and another beacon with the same seed, give other noise") {
    Run other = run;
    other.seed = 12;
    CHECK(events != events_of(all_steps(SensorSettings{}, other)));
    other = run;
    other.address = 8;
    const auto neighbour = events_of(all_steps(SensorSettings{}, other));
    const auto& mine = std::get<ImuSample>(events.front());
    const auto& theirs = std::get<ImuSample>(neighbour.front());
    CHECK(mine.specific_force_body_mps2 != theirs.specific_force_body_mps2);
  }
  THEN("the fixes' settings leave the IMU's noise alone") {
    SensorSettings settings;
    settings.fix_noise_m = 0.5;
    settings.pair_heading = false;
    std::vector<Vector3d> before;
    std::vector<Vector3d> after;
    for (const auto* imu : test::each<ImuSample>(events)) before.push_back(imu->specific_force_body_mps2);
    for (const Step& step : all_steps(settings, run)) {
      CHECK_FALSE(std::holds_alternative<PairHeading>(step.event));
      if (const auto* imu = std::get_if<ImuSample>(&step.event))
        after.push_back(imu->specific_force_body_mps2);
    }
    CHECK(before == after);
  }
}

SCENARIO("the simulator ends on time") {
  CHECK(all_steps(SensorSettings{}, {.duration_s = 0.0}).empty());
  GIVEN("no duration") {
    Simulator simulator(find_scenario("rest"), SensorSettings{}, {});
    THEN("it goes on") {
      for (int i = 0; i < 100'000; ++i) REQUIRE(simulator.next().has_value());
    }
  }
  GIVEN("no fixes") {
    SensorSettings settings;
    settings.fix_rate_hz = 0;
    THEN("it ends with the IMU samples") {
      CHECK(all_steps(settings, {.duration_s = 1.0}).size() == 100);
    }
  }
}

SCENARIO("invalid sensor settings are refused") {
  const auto refusal = [](auto change) {
    SensorSettings settings;
    change(settings);
    try {
      const Simulator simulator(find_scenario("rest"), settings, {});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refusal([](auto& s) { s.imu_rate_hz = 0; }), Catch::Contains("imu_rate_hz"));
  CHECK_THAT(refusal([](auto& s) { s.fix_noise_m = -0.1; }), Catch::Contains("fix_noise_m"));
  CHECK_THAT(refusal([](auto& s) { s.fix_rate_hz = std::nan(""); }), Catch::Contains("fix_rate_hz"));
  CHECK(refusal([](auto&) {}) == "accepted");
}

}  // namespace simulator_test
