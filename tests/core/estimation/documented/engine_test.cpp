/// The whole engine: known motions, interaction of the stages, reset.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace engine_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

double rms_error_m(const EngineDriver& driver, double from_s) {
  double squares = 0.0;
  int count = 0;
  for (const auto& moment : driver.moments) {
    if (moment.time_s < from_s) continue;
    squares += moment.position_error_m() * moment.position_error_m();
    ++count;
  }
  return std::sqrt(squares / count);
}

TEST_CASE("perfect sensors give the true pose: rest, line and circle, slow and fast") {
  struct Case {
    const char* name;
    test::Motion motion;
  };
  // In a steady turn the apparent gravity leans outwards permanently and misleads every filter that levels.
  // Without levelling, the gyro alone must be exact.
  Settings settings;
  settings.attitude.selection.filter = attitude::FilterKind::gyro;
  for (const auto& [name, motion] : {Case{"rest", test::at_rest({5, -3, 2})},
                                     {"walk", test::departure(1.3)},
                                     {"forklift", test::departure(3.0, 0.2)},
                                     {"kart", test::departure(6.0, 0.125)}}) {
    INFO(name);
    EngineDriver driver(settings, motion, test::with_headings());
    driver.run(20.0);
    CHECK(test::worst_error_m(driver.moments, 5.0) < 0.02);
    const auto& last = driver.moments.back();
    CHECK((last.pose.velocity_world_mps - last.truth.velocity_world_mps).norm() < 0.1);
    CHECK(geometry::wrap_angle(geometry::yaw_of(last.pose.q_body_to_world) - last.truth.yaw_rad) ==
          Approx(0.0).margin(0.01));
    CHECK(last.pose.status == 0);
  }
}

TEST_CASE("noisy fixes are smoothed: the output is closer to the truth than the fixes") {
  for (const double speed_mps : {0.0, 3.0, 6.0}) {
    INFO("speed " << speed_mps);
    EngineDriver driver(Settings{}, test::departure(speed_mps), test::with_headings(0.02));
    driver.run(60.0);
    CHECK(rms_error_m(driver, 5.0) < 0.02 * std::sqrt(3.0));
  }
}

TEST_CASE("every IMU sample gives a pose with its number and times") {
  EngineDriver driver(Settings{}, test::at_rest());
  driver.alter_imu = [](ImuSample& imu, double) { imu.bridge_time_ns = imu.sensor_time_ns + 1234; };
  driver.run(2.0);
  REQUIRE(driver.moments.size() == 200);
  const FusedPose& pose = driver.moments.back().pose;
  CHECK(pose.address == 7);
  CHECK(pose.time_ns == EngineDriver::stamp(1.99));
  CHECK(pose.imu_sensor_time_ns == pose.time_ns);
  CHECK(pose.imu_bridge_time_ns == pose.time_ns + 1234);
  CHECK(pose.sequence > driver.moments.front().pose.sequence);
}

TEST_CASE("before any fix the status says that there is no position") {
  Engine engine{Settings{}};
  const auto pose = engine.predict(test::imu_on(test::Truth{}, test::epoch_ns));
  REQUIRE(pose.has_value());
  CHECK((pose->status & status_initialising) != 0);
  CHECK((pose->status & status_heading_unknown) != 0);
  CHECK(std::isinf(pose->since_valid_fix_s));
  CHECK(test::is_finite(*pose));
}

TEST_CASE("item 3 at zero leaves the velocity to the IMU, from the first fix on") {
  Settings settings;
  settings.preset.imu_weight = ImuWeight::user;
  settings.velocity.blend_weight = 0.0;
  settings.velocity.overshoot_fix = false;
  settings.velocity.undershoot_fix = false;
  test::Sensors sensors;
  sensors.noise_m = 0.02;
  EngineDriver driver(settings, test::at_rest(), sensors);
  driver.run(5.0);
  REQUIRE(driver.reports.size() > 30);
  for (const FixReport& report : driver.reports) {
    if (report.applied_time_ns > EngineDriver::stamp(1.1))
      CHECK(report.velocity_change_world_mps.norm() == 0.0);
  }
}

TEST_CASE("an accepted track gives no velocity across its jump") {
  Settings settings;
  SECTION("item 19") {
    settings.trust.n_max = 3;
  }
  SECTION("item 20") {
    settings.trust.stuck_n = 2;
  }
  SECTION("item 15 off") {
    settings.trust.enabled = false;
  }
  EngineDriver driver(settings, test::at_rest());
  driver.run(5.0);
  driver.alter_fix = [](UltrasonicFix& fix, double) { fix.position_world_m.x() += 2.0; };
  driver.run(5.0);
  REQUIRE(driver.reports.size() > 60);
  for (const FixReport& report : driver.reports) CHECK(report.velocity_change_world_mps.norm() < 0.5);
  CHECK(driver.moments.back().pose.position_world_m.x() == Approx(2.0).margin(0.05));
}

TEST_CASE("the report on every fix is consistent") {
  EngineDriver driver(Settings{}, test::departure(2.0, 0.1), test::with_headings(0.02));
  driver.run(10.0);
  REQUIRE_FALSE(driver.reports.empty());
  CHECK((driver.reports.front().flags & fix_first) != 0);
  std::uint64_t used = 0;
  for (const auto& report : driver.reports) {
    if ((report.flags & fix_used) != 0) ++used;
    REQUIRE(report.weight >= 0.0);
    REQUIRE(report.weight <= 1.0);
    REQUIRE(report.applied_time_ns >= report.emission_time_ns);
    REQUIRE(report.sequence > 0);
  }
  CHECK(used == driver.engine.counters().fixes_used);
  CHECK(driver.engine.counters().fixes_rejected == driver.reports.size() - used);
}

TEST_CASE("the time since the last valid fix is never negative") {
  // A fix may be received just after the stamp of the next IMU sample.
  EngineDriver driver(Settings{}, test::at_rest());
  driver.run(3.0);
  UltrasonicFix fix;
  fix.emission_time_ns = driver.stamp(driver.time_s() - 0.05);
  fix.received_time_ns = driver.stamp(driver.time_s() + 0.018);
  REQUIRE((driver.engine.correct(fix).flags & fix_used) != 0);
  CHECK(driver.run(0.01).pose.since_valid_fix_s >= 0.0);
}

}  // namespace engine_test
