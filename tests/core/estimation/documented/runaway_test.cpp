/// Runaway damping (items 23 and 24).

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace runaway_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

RunawaySettings plain() {
  RunawaySettings settings;
  settings.position_error_m = 2.0;
  settings.velocity_damp_max_hz = 8.0;
  return settings;
}

/// Damping rate of the speed (1/s), `distance_m` from the last fix.
double damping_hz(double distance_m, const Vector3d& velocity_world_mps) {
  const RunawayState state{true, {1, 1, 1}};
  Kinematics body;
  body.position_world_m = Vector3d(1, 1, 1) + distance_m * Vector3d::UnitX();
  body.velocity_world_mps = velocity_world_mps;
  runaway::damp(plain(), state, body, 0.01);
  return -std::log(body.velocity_world_mps.norm() / velocity_world_mps.norm()) / 0.01;
}

TEST_CASE(
    "items 23 and 24: damping rises linearly from the threshold to its maximum at twice the threshold") {
  const Vector3d away(3, 0, 0);
  CHECK(damping_hz(1.0, away) == 0.0);
  CHECK(damping_hz(2.0, away) == 0.0);
  CHECK(damping_hz(2.5, away) == Approx(2.0));
  CHECK(damping_hz(3.0, away) == Approx(4.0));
  CHECK(damping_hz(4.0, away) == Approx(8.0));
  CHECK(damping_hz(40.0, away) == Approx(8.0));
}

TEST_CASE("item 23: a velocity that does not lead away is not damped") {
  CHECK(damping_hz(5.0, {-3, 0, 0}) == 0.0);
  CHECK(damping_hz(5.0, {0, 3, 0}) == 0.0);
  CHECK(damping_hz(5.0, {0.1, 3, 0}) > 0.0);
}

TEST_CASE("item 23: before any fix nothing is damped") {
  Kinematics body;
  body.position_world_m = {100, 0, 0};
  body.velocity_world_mps = {3, 0, 0};
  runaway::damp(plain(), RunawayState{}, body, 0.01);
  CHECK(body.velocity_world_mps == Vector3d(3, 0, 0));
}

TEST_CASE("the reference is the last fix that was no outlier, carried along by outliers that agree") {
  RunawayState state;
  TimedFix fix;
  fix.shifted_position_world_m = {1, 0, 0};
  runaway::update_reference(state, fix, FixAssessment{});
  CHECK(state.has_fix);
  CHECK(state.fix_position_world_m == Vector3d(1, 0, 0));
  FixAssessment outlier;
  outlier.outlier = true;
  fix.shifted_position_world_m = {1, 9, 0};
  runaway::update_reference(state, fix, outlier);
  CHECK(state.fix_position_world_m == Vector3d(1, 0, 0));
  outlier.rival_step_world_m = {0.5, 0, 0};
  runaway::update_reference(state, fix, outlier);
  CHECK(state.fix_position_world_m == Vector3d(1.5, 0, 0));
}

TEST_CASE("item 23: a wrong track does not slow a body that moves away from it") {
  for (const double speed_mps : {1.2, 6.0}) {
    Settings settings;
    settings.runaway.position_error_m = 1.5;
    test::EngineDriver driver(settings, test::departure(speed_mps), test::with_headings(0.02));
    driver.run(6.0);
    driver.alter_fix = [](UltrasonicFix& fix, double time_s) {
      if (time_s > 6.0 && time_s < 7.5) fix.position_world_m.x() -= 2.0;
    };
    driver.run(3.0);
    double slowest_mps = speed_mps;
    for (const auto& moment : driver.moments) {
      if (moment.time_s > 6.0) slowest_mps = std::min(slowest_mps, moment.pose.velocity_world_mps.x());
    }
    INFO(speed_mps << " m/s");
    CHECK(slowest_mps > speed_mps - 0.2);
    CHECK(test::worst_error_m(driver.moments, 6.0) < 0.15);
  }
}

TEST_CASE("item 23 by default exceeds the lag of real motion: it does not slow a kart") {
  Settings off;
  off.runaway.velocity_damp_max_hz = 0.0;
  test::EngineDriver with(Settings{}, test::departure(6.0, 0.125));
  test::EngineDriver without(off, test::departure(6.0, 0.125));
  with.run(15.0);
  without.run(15.0);
  CHECK(with.moments.back().pose.position_world_m == without.moments.back().pose.position_world_m);
}

TEST_CASE("items 23 and 24, in the engine: a gross accelerometer error is kept within range of the fixes") {
  const auto farthest_m = [](double max_hz) {
    Settings settings;
    settings.runaway.velocity_damp_max_hz = max_hz;
    settings.outage.stale_after_s = 60.0;  // only the damping limits the error
    test::EngineDriver driver(settings, test::at_rest());
    driver.run(3.0);
    driver.fixes_on = false;
    driver.alter_imu = [](ImuSample& imu, double) { imu.specific_force_body_mps2.x() += 2.0; };
    driver.run(10.0);
    return test::worst_error_m(driver.moments, 3.0);
  };
  CHECK(farthest_m(10.0) < 10.0);
  CHECK(farthest_m(0.0) > 50.0);
}

}  // namespace runaway_test
