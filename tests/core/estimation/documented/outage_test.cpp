/// Outages of the fixes (items 10 and 11) and gaps of the IMU.

#include <sonopose/samples/time_jump.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace outage_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

double speed_of(const test::Moment& moment) {
  return moment.pose.velocity_world_mps.norm();
}

/// Drives for 8 s, then stops the ultrasound and waits for the fixes in flight.
EngineDriver driver_into_silence(const Settings& settings, double speed_mps = 3.0) {
  EngineDriver driver(settings, test::departure(speed_mps));
  driver.run(8.0);
  driver.fixes_on = false;
  driver.run(0.2);
  return driver;
}

TEST_CASE("item 11: stale mode begins the set time after the last valid fix") {
  for (const double stale_after_s : {0.5, 1.0, 3.0}) {
    Settings settings;
    settings.outage.stale_after_s = stale_after_s;
    EngineDriver driver = driver_into_silence(settings);
    const TimeNs last_ns = driver.engine.state().outage.last_valid_fix_ns;
    driver.run(stale_after_s + 1.0);
    INFO("stale after " << stale_after_s);
    for (const auto& moment : driver.moments) {
      const double since_s = seconds_between(last_ns, moment.pose.time_ns);
      if (since_s < 0.0) continue;
      REQUIRE(moment.has(status_stale) == (since_s > stale_after_s));
      REQUIRE(moment.pose.since_valid_fix_s == Approx(since_s));
    }
  }
}

TEST_CASE("item 11: an outlier is a valid fix, one below the minimum quality is not") {
  const auto stale_with = [](const std::function<void(UltrasonicFix&, double)>& alter) {
    EngineDriver driver(Settings{}, test::departure(1.0));
    driver.run(5.0);
    driver.alter_fix = alter;
    return driver.run(2.0).has(status_stale);
  };
  CHECK_FALSE(
      stale_with([](UltrasonicFix& fix, double t) { fix.position_world_m.y() += 50.0 * std::sin(9.0 * t); }));
  CHECK(stale_with([](UltrasonicFix& fix, double) { fix.quality_percent = 20.0; }));
}

TEST_CASE("item 10: in stale mode the speed falls as exp(−rate·t)") {
  for (const double rate_hz : {0.5, 2.0}) {
    Settings settings;
    settings.outage.velocity_decay_rate_hz = rate_hz;
    EngineDriver driver = driver_into_silence(settings);
    driver.run(1.0);
    const double begin_mps = speed_of(driver.moments.back());
    REQUIRE(driver.moments.back().has(status_stale));
    driver.run(1.5);
    INFO("rate " << rate_hz);
    CHECK(speed_of(driver.moments.back()) / begin_mps == Approx(std::exp(-1.5 * rate_hz)).epsilon(0.001));
  }
}

TEST_CASE("item 11: in stale mode acceleration has no effect") {
  EngineDriver calm = driver_into_silence(Settings{});
  EngineDriver shaken = driver_into_silence(Settings{});
  calm.run(1.0);
  shaken.run(1.0);
  shaken.alter_imu = [](ImuSample& imu, double) { imu.specific_force_body_mps2.x() += 3.0; };
  calm.run(2.0);
  shaken.run(2.0);
  CHECK((calm.moments.back().pose.velocity_world_mps - shaken.moments.back().pose.velocity_world_mps).norm() <
        1e-12);
  CHECK((calm.moments.back().pose.position_world_m - shaken.moments.back().pose.position_world_m).norm() <
        1e-9);
}

TEST_CASE("item 11: the first valid fix ends it and sets the position, the second sets the velocity") {
  EngineDriver driver = driver_into_silence(Settings{}, 4.0);
  driver.run(6.0);
  REQUIRE(driver.moments.back().position_error_m() > 5.0);
  driver.fixes_on = true;
  const std::size_t before = driver.reports.size();
  while (driver.reports.size() == before) driver.run(0.01);
  CHECK((driver.reports.back().flags & fix_stale_recovered) != 0);
  CHECK_FALSE(driver.moments.back().has(status_stale));
  // The velocity has decayed, so the fix cannot be extrapolated: an error of v × delay remains.
  CHECK(driver.moments.back().position_error_m() < 4.0 * 0.09);
  while (driver.reports.size() == before + 1) driver.run(0.01);
  CHECK((driver.reports.back().flags & fix_outlier) == 0);
  CHECK(driver.moments.back().pose.velocity_world_mps.x() == Approx(4.0).epsilon(0.01));
  CHECK(driver.moments.back().position_error_m() < 0.02);
  CHECK(driver.moments.back().pose.trust == 1.0);
}

TEST_CASE("a start at speed: the second fix sets the velocity at any speed") {
  for (const double speed_mps : {1.0, 6.0, 15.0}) {
    EngineDriver driver(Settings{}, test::constant_velocity(speed_mps));
    // The body rocks all the time and is never at rest to be calibrated.
    driver.alter_imu = [](ImuSample& imu, double time_s) {
      imu.angular_velocity_body_radps.z() += 0.1 * std::sin(20.0 * time_s);
    };
    const auto moment = driver.run(2.0);
    INFO("speed " << speed_mps);
    CHECK(moment.has(status_uncalibrated));
    CHECK(moment.pose.velocity_world_mps.x() == Approx(speed_mps).epsilon(0.02));
    CHECK(moment.position_error_m() < 0.05);
  }
}

SCENARIO("slow fixes correct the velocity too, where they are not so far apart that the engine is stale") {
  GIVEN("fixes as rare as two a second and one a second, and a body on a circle") {
    test::Sensors sensors = test::with_headings();
    sensors.fix_rate_hz = GENERATE(2.0, 1.05);
    CAPTURE(sensors.fix_rate_hz);
    EngineDriver driver(Settings{}, test::departure(1.0, 0.3), sensors);
    WHEN("the accelerometer is off by 0.03 m/s² after the rest at the start") {
      driver.alter_imu = [](ImuSample& imu, double time_s) {
        if (time_s > 2.0) imu.specific_force_body_mps2.x() += 0.03;
      };
      const auto moment = driver.run(60.0);
      THEN("the pose stays within what this adds up to between two fixes, several times over") {
        CHECK_FALSE(moment.has(status_stale));
        CHECK(test::worst_error_m(driver.moments, 10.0) < 0.2);
      }
    }
  }
}

TEST_CASE("a gap of the IMU is not integrated over") {
  for (const double gap_s : {0.5, 5.0, 300.0}) {
    INFO("gap of " << gap_s << " s");
    EngineDriver driver(Settings{}, test::departure(3.0));
    driver.run(8.0);
    const auto before = driver.moments.back();
    driver.imu_on_air = false;
    driver.fixes_on = gap_s < 10.0;  // covers both cases: with and without fixes meanwhile
    driver.run(gap_s);
    driver.imu_on_air = true;
    driver.fixes_on = true;
    const int samples = gap_s > 2.0 ? max_ahead_samples + 1 : 1;  // more than a few confirm a long gap
    const auto after = driver.run(0.01 * samples);
    CHECK(after.has(status_imu_gap));
    CHECK(driver.engine.counters().imu_gaps == 1);
    CHECK((after.pose.position_world_m - before.pose.position_world_m).norm() < 4.0);
    CHECK(speed_of(after) <= speed_of(before));
    const auto later = driver.run(1.0);
    CHECK_FALSE(later.has(status_imu_gap));
    CHECK(later.position_error_m() < 0.03);
    CHECK(later.pose.velocity_world_mps.x() == Approx(3.0).epsilon(0.05));
  }
}

TEST_CASE("the pose after a gap uses the measurement after it") {
  EngineDriver driver(Settings{}, test::at_rest());
  driver.run(3.0);
  driver.alter_imu = [](ImuSample& imu, double) { imu.angular_velocity_body_radps.z() += 1.0; };
  driver.run(1.0);
  driver.imu_on_air = false;
  driver.run(1.0);
  driver.imu_on_air = true;
  driver.alter_imu = nullptr;
  const auto after = driver.run(0.01);
  CHECK(after.pose.angular_velocity_body_radps.norm() < 1e-3);
  const double yaw_rad = geometry::yaw_of(after.pose.q_body_to_world);
  const auto next = driver.run(0.01);
  CHECK(geometry::yaw_of(next.pose.q_body_to_world) == Approx(yaw_rad).margin(1e-4));
}

TEST_CASE("a few lost IMU samples are bridged") {
  test::EngineDriver driver(Settings{}, test::departure(3.0));
  int count = 0;
  driver.alter_imu = [&count](ImuSample& imu, double) {
    if (++count % 10 < 3) imu.sensor_time_ns = 0;  // not admitted, as if lost
  };
  driver.run(10.0);
  CHECK(driver.engine.counters().imu_gaps == 0);
  CHECK(test::worst_error_m(driver.moments, 5.0) < 0.03);
}

}  // namespace outage_test
