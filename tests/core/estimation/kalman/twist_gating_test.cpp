/// Velocities of wheels in the engine: outages, an unknown yaw, slip and scale.

#include "sim/simulator.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace twist_gating_test {

using namespace sonopose;
using estimation::kalman::Engine;

constexpr double outage_begin_s = 40.0;
constexpr double outage_s = 8.0;

/// A forklift that cannot move sideways, with a single beacon that is 0.2 m ahead of its fixed axle.
settings::Settings forklift_settings() {
  settings::Settings settings;
  settings.twist.lateral_std_mps = settings.twist.vertical_std_mps = 0.05;
  settings.twist.point_x_m = -0.2;
  return settings;
}

sim::Scenario drive(double wheel_rate_hz) {
  sim::Scenario scenario = sim::find_scenario("forklift");
  scenario.sensors.pair_heading = false;
  scenario.sensors.wheel_rate_hz = wheel_rate_hz;
  scenario.sensors.wheel_scale_error = 0.025;
  scenario.random_start_yaw = true;
  scenario.disturbances.outages = {{outage_begin_s, outage_s}};
  return scenario;
}

sim::Scenario walk_of_unknown_yaw(double wheel_scale_error) {
  sim::Scenario scenario = sim::find_scenario("walk");
  scenario.sensors.pair_heading = false;
  scenario.sensors.wheel_rate_hz = 50.0;
  scenario.sensors.wheel_scale_error = wheel_scale_error;
  scenario.random_start_yaw = true;
  return scenario;
}

struct Result {
  double outage_end_m = 0;            ///< error at the end of the outage
  std::optional<double> yaw_known_s;  ///< after 0.3 m/s were reached
  double yaw_error_deg = 0;           ///< at that time
  std::optional<double> slip_found_s;
  double scale_error = 0;
  double rms_m = 0;  ///< error after 6 s
  double agreed_s = 0;
  bool are_proven = false;
  EstimatorCounters counters;
};

Result run(const sim::Scenario& scenario, std::uint64_t seed, const settings::Settings& settings,
           double slip_begin_s = 1e9) {
  const sim::Run run{.seed = seed, .duration_s = 60.0};
  sim::Simulator simulator(scenario, run);
  Engine engine(settings);
  Result result;
  std::optional<double> driving_s;
  std::uint64_t rejected_before = 0;
  double sum_m2 = 0;
  int scored = 0;
  while (const auto step = simulator.next()) {
    const double time_s = seconds_between(run.start_time_ns, available_at_ns(step->event));
    if (const auto* imu = std::get_if<ImuSample>(&step->event)) {
      const auto pose = engine.predict(*imu);
      if (!pose || !step->truth) continue;
      const double error_m = (pose->position_world_m - step->truth->position_world_m).norm();
      if (time_s > 6.0) {
        sum_m2 += error_m * error_m;
        ++scored;
      }
      if (!driving_s && step->truth->velocity_world_mps.norm() > 0.3) driving_s = time_s;
      if (driving_s && !result.yaw_known_s && (pose->status & status_heading_unknown) == 0) {
        result.yaw_known_s = time_s - *driving_s;
        result.yaw_error_deg =
            std::abs(geometry::wrap_angle(geometry::yaw_of(pose->q_body_to_world) -
                                          geometry::yaw_of(step->truth->q_body_to_world))) /
            geometry::radians_per_degree;
      }
      if (time_s < outage_begin_s + outage_s) result.outage_end_m = error_m;
    } else {
      std::visit(
          [&](const auto& sample) {
            if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(sample)>, ImuSample>)
              engine.correct(sample);
          },
          step->event);
    }
    const std::uint64_t rejected = engine.counters().twists_rejected;
    if (time_s < slip_begin_s) rejected_before = rejected;
    if (!result.slip_found_s && rejected > rejected_before) result.slip_found_s = time_s - slip_begin_s;
  }
  if (engine.state().filter().scale) result.scale_error = engine.state().filter().scale->error;
  result.rms_m = std::sqrt(sum_m2 / std::max(scored, 1));
  if (engine.state().twist) {
    result.agreed_s = engine.state().twist->agreed_s;
    result.are_proven = engine.state().twist->are_proven();
  }
  result.counters = engine.counters();
  return result;
}

SCENARIO("wheel speeds bridge an outage of the fixes and find the yaw", "[accuracy]") {
  const unsigned seeds = test::seeds(3, 40);
  double sum_with_m = 0;
  double sum_without_m = 0;
  for (std::uint64_t seed = 43001; seed < 43001 + seeds; ++seed) {
    const Result with = run(drive(50.0), seed, forklift_settings());
    const Result without = run(drive(0.0), seed, forklift_settings());
    CAPTURE(seed, with.outage_end_m, without.outage_end_m, with.yaw_known_s.value_or(-1.0), with.scale_error);
    CHECK(with.outage_end_m < 0.15);
    sum_with_m += with.outage_end_m;
    sum_without_m += without.outage_end_m;
    REQUIRE(with.yaw_known_s);
    CHECK(*with.yaw_known_s < 2.0);
    CHECK(with.yaw_error_deg < 10.0);
    CHECK(with.scale_error == Approx(0.025).margin(0.015));
    CHECK(with.counters.twists_used > 2500);
  }
  CHECK(sum_with_m < 0.5 * sum_without_m);
}

SCENARIO("wheel speeds along headings of a wrong mount do not draw the pose off the fixes") {
  GIVEN("a vehicle whose pair is mounted at an angle that the settings do not name") {
    sim::Scenario scenario = sim::find_scenario(GENERATE("kart", "forklift", "walk"));
    scenario.sensors.wheel_rate_hz = 50.0;
    settings::Settings settings;
    settings.heading.mount_offset_deg = GENERATE(90.0, 180.0);
    const Result result = run(scenario, 44001, settings);
    CAPTURE(scenario.name, settings.heading.mount_offset_deg);
    THEN("the pose stays with the fixes") {
      CHECK(result.rms_m < 0.3);
    }
  }
}

SCENARIO("wheel speeds of a wrong scale do not draw a pose of unknown yaw off the fixes") {
  GIVEN("a walk from an unknown direction whose wheel speeds are off by more than the scale may be") {
    const double scale_error = GENERATE(-0.4, 0.3, 0.5, 0.7);
    const Result result = run(walk_of_unknown_yaw(scale_error), GENERATE(45001U, 45002U), {});
    CAPTURE(scale_error);
    THEN("the error is less than the noise of a fix") {
      CHECK(result.rms_m < 0.03);
    }
  }
}

SCENARIO("wheel speeds along wrong headings do not prolong dead reckoning") {
  GIVEN("a walk with a wrong mount offset, whose fixes pause for eight seconds") {
    sim::Scenario scenario = sim::find_scenario("walk");
    scenario.disturbances.outages = {{outage_begin_s, outage_s}};
    settings::Settings settings;
    settings.heading.mount_offset_deg = GENERATE(90.0, 180.0);
    const Result without = run(scenario, 46001, settings);
    scenario.sensors.wheel_rate_hz = 50.0;
    const Result with = run(scenario, 46001, settings);
    THEN("the pose stops as it does without them") {
      CHECK(with.outage_end_m < without.outage_end_m + 2.0);
    }
  }
}

SCENARIO("wheels that have agreed are right, and those of a wrong scale never agree") {
  GIVEN("a walk from an unknown direction") {
    const double scale_error = GENERATE(0.0, 0.1, 0.3, -0.3);
    const Result result = run(walk_of_unknown_yaw(scale_error), 47001, {});
    CAPTURE(scale_error, result.agreed_s);
    THEN("a scale that the estimate can have is proven, another one not") {
      CHECK(result.are_proven == (std::abs(scale_error) < 0.15));
    }
  }
}

SCENARIO("slipping wheels are rejected") {
  GIVEN("a kart on a circle whose wheels slip by 30 % for two seconds") {
    constexpr double slip_begin_s = 20.0;
    sim::Scenario scenario = sim::find_scenario("circle");
    scenario.sensors.wheel_rate_hz = 50.0;
    const double by = GENERATE(-0.3, 0.3);
    scenario.disturbances.wheel_slips = {{slip_begin_s, 2.0, by}};
    const Result result = run(scenario, 41001, {}, slip_begin_s);
    THEN("this is found within half a second, and nearly all of these velocities are rejected") {
      REQUIRE(result.slip_found_s);
      CHECK(*result.slip_found_s < 0.5);
      CHECK(result.counters.twists_rejected > 90);
      CHECK(result.counters.twists_rejected < 130);
      CHECK(std::abs(result.scale_error) < 0.01);
    }
  }
}

SCENARIO("velocities that the engine cannot use are counted") {
  GIVEN("an engine that tracks") {
    sim::Scenario scenario = sim::find_scenario("walk");
    const sim::Run run{.duration_s = 10.0};
    sim::Simulator simulator(scenario, run);
    settings::Settings settings;
    settings.twist.enabled = GENERATE(true, false);
    Engine engine(settings);
    while (const auto step = simulator.next()) {
      if (const auto* imu = std::get_if<ImuSample>(&step->event)) engine.predict(*imu);
      if (const auto* fix = std::get_if<UltrasonicFix>(&step->event)) engine.correct(*fix);
    }
    TwistSample twist{.emission_time_ns = engine.time_ns(), .received_time_ns = engine.time_ns()};
    const auto before = engine.snapshot().history;
    WHEN("a sample has an angular velocity only") {
      twist.axes = twist_angular_velocity_z;
      engine.correct(twist);
      THEN("it changes nothing") {
        CHECK(engine.counters().twists_unused == 1);
        CHECK(engine.snapshot().history == before);
      }
    }
    WHEN("a sample is not finite") {
      twist.axes = twist_velocity_x;
      twist.velocity_body_mps.x() = std::numeric_limits<double>::quiet_NaN();
      engine.correct(twist);
      THEN("it is invalid") {
        CHECK(engine.counters().samples_invalid == 1);
        CHECK(engine.snapshot().history == before);
      }
    }
    WHEN("a sample is too old or too new") {
      twist.axes = twist_velocity_x;
      twist.emission_time_ns += GENERATE(-3'000'000'000, 11'000'000'000);
      twist.received_time_ns = std::max(twist.received_time_ns, twist.emission_time_ns);
      engine.correct(twist);
      THEN("it is not used") {
        CHECK(engine.counters().twists_unused == 1);
        CHECK(engine.snapshot().history == before);
      }
    }
    WHEN("velocities are turned off") {
      if (settings.twist.enabled) return;
      twist.axes = twist_velocity_x;
      engine.correct(twist);
      THEN("they are not used") {
        CHECK(engine.counters().twists_unused == 1);
        CHECK(engine.snapshot().history == before);
      }
    }
  }
}

SCENARIO("velocities and headings that are newer than the IMU samples count as unused") {
  GIVEN("a walk whose velocities and headings have stamps 0.7 s ahead") {
    constexpr TimeNs ahead_ns = 700'000'000;
    sim::Scenario scenario = sim::find_scenario("forklift");
    scenario.sensors.wheel_rate_hz = 50.0;
    sim::Simulator simulator(scenario, {.duration_s = 20.0});
    Engine engine({});
    Engine without({});
    std::uint64_t twists = 0;
    std::uint64_t headings = 0;
    while (const auto step = simulator.next()) {
      if (const auto* imu = std::get_if<ImuSample>(&step->event)) {
        engine.predict(*imu);
        without.predict(*imu);
      }
      if (const auto* fix = std::get_if<UltrasonicFix>(&step->event)) {
        engine.correct(*fix);
        without.correct(*fix);
      }
      const auto move_ahead = [](auto sample) {
        sample.emission_time_ns += ahead_ns;
        sample.received_time_ns = std::max(sample.received_time_ns, sample.emission_time_ns);
        return sample;
      };
      if (const auto* twist = std::get_if<TwistSample>(&step->event)) {
        ++twists;
        engine.correct(move_ahead(*twist));
      }
      if (const auto* heading = std::get_if<PairHeading>(&step->event)) {
        ++headings;
        engine.correct(move_ahead(*heading));
      }
    }
    THEN("none is counted as used, and the poses are those without them") {
      const EstimatorCounters& counted = engine.counters();
      REQUIRE(twists > 900);
      REQUIRE(headings > 100);
      CHECK(counted.twists_used + counted.twists_rejected <= 1);  // the last one may wait for a sample
      CHECK(counted.twists_used + counted.twists_rejected + counted.twists_unused == twists);
      CHECK(counted.headings <= 1);
      CHECK(counted.headings + counted.samples_invalid == headings);
      CHECK(engine.state().filter().position_world_m == without.state().filter().position_world_m);
    }
  }
}

SCENARIO("velocities that arrive late give the same state") {
  GIVEN("a drive whose velocities come in time, or 0.2 s late") {
    const auto final_state = [](double delay_s) {
      sim::Scenario scenario = sim::find_scenario("walk");
      scenario.sensors.wheel_rate_hz = 20.0;
      scenario.sensors.wheel_delay_s = delay_s;
      const sim::Run run{.seed = 3, .duration_s = 20.0};
      sim::Simulator simulator(scenario, run);
      Engine engine({});
      // None before the first fix arrives, which would not be used, and none that would still be on its way.
      while (const auto step = simulator.next()) {
        if (const auto* imu = std::get_if<ImuSample>(&step->event)) engine.predict(*imu);
        if (const auto* fix = std::get_if<UltrasonicFix>(&step->event)) engine.correct(*fix);
        if (const auto* heading = std::get_if<PairHeading>(&step->event)) engine.correct(*heading);
        const auto* twist = std::get_if<TwistSample>(&step->event);
        if (twist == nullptr) continue;
        const double time_s = seconds_between(run.start_time_ns, twist->emission_time_ns);
        if (time_s > 1.0 && time_s < 19.0) engine.correct(*twist);
      }
      engine.finish_pending_work();
      return engine.state().filter();
    };
    const auto prompt = final_state(0.001);
    const auto late = final_state(0.2);
    THEN("position, velocity and scale are the same") {
      CHECK((prompt.position_world_m - late.position_world_m).norm() < 1e-6);
      CHECK((prompt.velocity_world_mps - late.velocity_world_mps).norm() < 1e-6);
      REQUIRE(prompt.scale);
      CHECK(prompt.scale->error == Approx(late.scale->error).margin(1e-6));
    }
  }
}

}  // namespace twist_gating_test
