/// The frozen track: coordinates that repeat while the IMU moves.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace frozen_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

/// Makes every fix from `from_s` on repeat this spot.
auto freeze_at(const Vector3d& spot, double from_s) {
  return [spot, from_s](UltrasonicFix& fix, double time_s) {
    if (time_s >= from_s) fix.position_world_m = spot;
  };
}

int count_flag(const EngineDriver& driver, FixFlag bit) {
  int count = 0;
  for (const FixReport& report : driver.reports) count += (report.flags & bit) != 0 ? 1 : 0;
  return count;
}

TEST_CASE("fixes that repeat one spot while the body drives are a frozen track") {
  const double speed_mps = GENERATE(0.5, 2.0, 6.0);
  INFO("speed " << speed_mps);
  EngineDriver driver(Settings{}, test::departure(speed_mps));
  driver.run(8.0);
  REQUIRE(count_flag(driver, fix_frozen) == 0);
  driver.alter_fix = freeze_at(driver.moments.back().truth.position_world_m, driver.time_s());
  const auto moment = driver.run(1.2);
  CHECK(moment.has(status_frozen_track));
  CHECK((driver.reports.back().flags & fix_frozen) != 0);
  CHECK((driver.reports.back().flags & fix_used) == 0);

  WHEN("it lasts") {
    const auto later = driver.run(20.0);
    THEN("the pose stays bounded and stale mode says that no fix is valid") {
      CHECK(later.has(status_stale));
      CHECK(later.has(status_frozen_track));
      CHECK(later.pose.velocity_world_mps.norm() < 0.01);
      CHECK((later.pose.position_world_m - driver.reports.back().position_world_m).norm() < 4.0 * speed_mps);
    }
  }
  WHEN("the coordinates change again") {
    driver.alter_fix = nullptr;
    const auto later = driver.run(2.0);
    THEN("the first new coordinate ends it") {
      CHECK_FALSE(later.has(status_frozen_track));
      CHECK_FALSE(later.has(status_stale));
      CHECK(later.position_error_m() < 0.05);
    }
  }
}

TEST_CASE("at rest real beacons repeat coordinates too: not frozen") {
  EngineDriver driver(Settings{}, test::at_rest({1, 2, 0}));
  driver.run(60.0);
  CHECK(count_flag(driver, fix_frozen) == 0);
  CHECK_FALSE(driver.moments.back().has(status_frozen_track));
}

TEST_CASE("at rest with an imperfect accelerometer: not frozen") {
  test::Sensors sensors;
  EngineDriver driver(Settings{}, test::at_rest(), sensors);
  driver.alter_imu = [](ImuSample& imu, double time_s) {
    if (time_s > 2.0) imu.specific_force_body_mps2.x() += 0.1;  // 0.6 degrees of tilt
  };
  driver.run(60.0);
  CHECK(count_flag(driver, fix_frozen) == 0);
}

TEST_CASE("a drive that ends in a standstill is not frozen") {
  // A departure reversed in time: braking from 3 m/s within a second.
  const auto there = test::departure(3.0);
  const test::Motion brake = [there](double time_s) {
    if (time_s < 6.0) return there(time_s);
    const auto back = test::departure(3.0, 0.0, 0.0, 1.0);
    const double end_m = there(6.0).position_world_m.x() + back(1.0).position_world_m.x();
    test::Truth truth = back(std::max(0.0, 7.0 - time_s));
    truth.position_world_m.x() = end_m - truth.position_world_m.x();
    truth.acceleration_world_mps2 = -truth.acceleration_world_mps2;
    return truth;
  };
  EngineDriver driver(Settings{}, brake);
  driver.run(12.0);
  CHECK(count_flag(driver, fix_frozen) == 0);
  CHECK(driver.moments.back().position_error_m() < 0.02);
}

TEST_CASE("a silence of the IMU is no motion: at rest it does not freeze the track") {
  Settings settings;
  settings.alignment.tilt_gain_hz = 0.0;  // levelling would make the corrections unnecessary
  settings.attitude.selection.filter = attitude::FilterKind::gyro;
  EngineDriver driver(settings, test::at_rest());
  // The fixes permanently counter an accelerometer error, so the sum of corrections grows.
  driver.alter_imu = [](ImuSample& imu, double time_s) {
    if (time_s > 2.0) imu.specific_force_body_mps2.x() += 0.1;
  };
  driver.run(120.0);
  REQUIRE(driver.engine.state().body.velocity_corrections_world_mps.norm() > 0.5);
  const int before = count_flag(driver, fix_frozen);
  driver.imu_on_air = false;
  driver.run(5.0);
  driver.imu_on_air = true;
  driver.run(3.0);
  CHECK(before == 0);
  CHECK(count_flag(driver, fix_frozen) == 0);
  CHECK(driver.moments.back().position_error_m() < 0.2);
}

TEST_CASE("a few equal coordinates in slow motion are the beacon's resolution") {
  test::Sensors sensors;
  EngineDriver driver(Settings{}, test::departure(0.1), sensors);
  driver.alter_fix = [](UltrasonicFix& fix, double) {
    fix.position_world_m =
        (fix.position_world_m * 100.0).array().round().matrix() / 100.0;  // rounded to centimetres
  };
  driver.run(20.0);
  CHECK(count_flag(driver, fix_frozen) == 0);
}

}  // namespace frozen_test
