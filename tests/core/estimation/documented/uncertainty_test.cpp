/// Standard deviations of the pose against its errors.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/estimator.hpp>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <support/engine_driver.hpp>

namespace uncertainty_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

TEST_CASE("without fixes all deviations grow, that of the position faster and faster") {
  const UncertaintySettings settings;
  UncertaintyState state{0.02, 0.0, 0.01};
  for (int i = 0; i < 100; ++i) uncertainty::grow(settings, state, 0.01);
  CHECK(state.velocity_std_mps == Approx(settings.accel_std_mps2));
  CHECK(state.position_std_m == Approx(0.02 + 0.5 * settings.accel_std_mps2).epsilon(0.02));
  CHECK(state.yaw_std_rad == Approx(0.01 + settings.yaw_drift_std_degps * geometry::radians_per_degree));
}

TEST_CASE("no deviation exceeds the value for unknown") {
  UncertaintyState state;
  for (int i = 0; i < 1000; ++i) uncertainty::grow(UncertaintySettings{}, state, 10.0);
  CHECK(state.position_std_m == UncertaintyState::unknown_m);
  CHECK(state.velocity_std_mps == UncertaintyState::unknown_mps);
  CHECK(state.yaw_std_rad == Approx(M_PI / std::sqrt(3.0)));
}

TEST_CASE("a fix reduces the deviation according to its weight") {
  const UncertaintySettings settings;
  const auto after = [&settings](double weight) {
    UncertaintyState state{1.0, 1.0, 0.1};
    uncertainty::correct(settings, state, weight, 0.5 * weight, 0.3 * weight, 0.08);
    return state;
  };
  CHECK(after(1.0).position_std_m == Approx(0.5).epsilon(0.01));
  CHECK(after(0.1).position_std_m == Approx(0.95).epsilon(0.01));
  CHECK(after(0.0) == UncertaintyState{1.0, 1.0, 0.1});
  CHECK(after(1.0).velocity_std_mps < 1.0);
  CHECK(after(1.0).yaw_std_rad == 0.1);
}

TEST_CASE("a fix without a velocity does not change the velocity's deviation") {
  UncertaintyState state{1.0, 1.0, 0.1};
  uncertainty::correct(UncertaintySettings{}, state, 1.0, 0.5, 0.3, 0.0);
  CHECK(state.velocity_std_mps == 1.0);
}

TEST_CASE("the correction to a heading reduces yaw's deviation to that of the heading") {
  const UncertaintySettings settings;
  UncertaintyState state{1.0, 1.0, 1.0};
  for (int i = 0; i < 1000; ++i) uncertainty::correct_yaw(settings, state, 0.02);
  CHECK(state.yaw_std_rad == Approx(settings.heading_std_deg * geometry::radians_per_degree));
}

TEST_CASE("in-motion alignment reduces yaw's deviation, and never increases it") {
  UncertaintyState state;
  uncertainty::align_yaw(state, 0.0, 0.0);
  CHECK(state.yaw_std_rad == UncertaintyState::unknown_yaw_rad);
  for (int i = 0; i < 100; ++i) uncertainty::align_yaw(state, 0.1, 0.5);
  CHECK(state.yaw_std_rad < 0.25);
  const double before_rad = state.yaw_std_rad;
  uncertainty::align_yaw(state, 0.1, 10.0);
  CHECK(state.yaw_std_rad == before_rad);
}

/// Mean over the last 10 s of runs of 30 s without pair headings.
struct YawConsistency {
  double squared_error_rad2 = 0;
  double variance_rad2 = 0;
  double normalised = 0;  ///< squared error over its variance
};

YawConsistency yaw_consistency(const std::string& name) {
  YawConsistency mean;
  int count = 0;
  for (std::uint64_t seed = 7001; seed <= 7010; ++seed) {
    const sim::Scenario& scenario = sim::find_scenario(name);
    sim::SensorSettings sensors = scenario.sensors;
    sensors.pair_heading = false;
    sim::Simulator simulator(scenario, sensors, {.seed = seed, .duration_s = 30.0});
    Engine engine{Settings{}};
    TimeNs begin_ns = 0;
    while (auto step = simulator.next()) {
      const auto result = estimation::process(engine, step->event);
      const auto* pose = std::get_if<FusedPose>(&result);
      if (pose == nullptr) continue;
      if (begin_ns == 0) begin_ns = pose->time_ns;
      if (seconds_between(begin_ns, pose->time_ns) < 20.0) continue;
      const double error_rad = geometry::wrap_angle(geometry::yaw_of(pose->q_body_to_world) -
                                                    geometry::yaw_of(step->truth->q_body_to_world));
      const double std_rad = yaw_std_rad(*pose);
      mean.squared_error_rad2 += error_rad * error_rad;
      mean.variance_rad2 += std_rad * std_rad;
      mean.normalised += error_rad * error_rad / (std_rad * std_rad);
      ++count;
    }
  }
  mean.squared_error_rad2 /= count;
  mean.variance_rad2 /= count;
  mean.normalised /= count;
  return mean;
}

TEST_CASE("in the engine motion makes yaw known without a pair heading, within its standard deviation") {
  const std::string name = GENERATE("walk", "forklift", "kart", "drone", "no_heading");
  const YawConsistency yaw = yaw_consistency(name);
  fmt::print("{}: yaw error {:.1f} deg, standard deviation {:.1f} deg, normalised {:.2f}\n", name,
             std::sqrt(yaw.squared_error_rad2) / geometry::radians_per_degree,
             std::sqrt(yaw.variance_rad2) / geometry::radians_per_degree, yaw.normalised);
  CHECK(std::sqrt(yaw.variance_rad2) < 20.0 * geometry::radians_per_degree);
  CHECK(yaw.normalised < 1.0);
}

TEST_CASE("in the engine yaw remains unknown at rest without a pair heading") {
  const YawConsistency yaw = yaw_consistency("rest");
  CHECK(std::sqrt(yaw.variance_rad2) > 1.5);
}

TEST_CASE("in the engine it is unknown before the first fix, and centimetres soon after") {
  test::Sensors sensors;
  sensors.noise_m = 0.02;
  sensors.headings = true;
  test::EngineDriver driver(Settings{}, test::departure(2.0, 0.1), sensors);
  driver.fixes_on = false;
  const auto blind = driver.run(0.5);
  CHECK(position_std_m(blind.pose).x() >= 100.0);
  CHECK(yaw_std_rad(blind.pose) > 1.0);
  driver.fixes_on = true;
  const auto seeing = driver.run(2.0);
  CHECK(position_std_m(seeing.pose).x() < 0.1);
  CHECK(velocity_std_mps(seeing.pose).x() < 1.0);
  CHECK(yaw_std_rad(seeing.pose) < 0.1);
}

TEST_CASE("in the engine the position's standard deviation matches the errors") {
  test::Sensors sensors;
  sensors.noise_m = 0.02;
  sensors.headings = true;
  test::EngineDriver driver(Settings{}, test::departure(2.0, 0.1), sensors);
  driver.run(60.0);
  double squares = 0.0;
  double variances = 0.0;
  for (const auto& moment : driver.moments) {
    if (moment.time_s < 10.0) continue;
    squares += (moment.pose.position_world_m - moment.truth.position_world_m).squaredNorm();
    variances += position_std_m(moment.pose).squaredNorm();
  }
  const double ratio = std::sqrt(squares / variances);
  CHECK(ratio > 0.2);
  CHECK(ratio < 1.5);
}

TEST_CASE("in the engine it grows without fixes, at least as fast as the error") {
  test::Sensors sensors;
  sensors.noise_m = 0.02;
  test::EngineDriver driver(Settings{}, test::departure(2.0, 0.1), sensors);
  driver.run(10.0);
  driver.fixes_on = false;
  driver.run(0.1);
  const double before_m = position_std_m(driver.moments.back().pose).x();
  const auto after = driver.run(0.8);
  CHECK(position_std_m(after.pose).x() > before_m + 0.05);
  CHECK(after.position_error_m() < 3.0 * std::sqrt(3.0) * position_std_m(after.pose).x());
}

}  // namespace uncertainty_test
