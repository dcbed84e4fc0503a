/// Start-up: the gyro's offset is measured only at rest.

#include <catch2/catch.hpp>

#include <random>
#include <support/engine_driver.hpp>

namespace startup_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

const Vector3d offset_radps(0.01, -0.02, 0.015);

test::Sensors offset_sensors() {
  test::Sensors sensors;
  sensors.gyro_offset_body_radps = offset_radps;
  return sensors;
}

/// Rocks about body X by 0.5 rad/s with the force kept on the body's Z: no rest.
void rock(ImuSample& imu, double time_s) {
  imu.angular_velocity_body_radps.x() += 0.5 * std::sin(10.0 * time_s);
}

startup::Progress run_for(const StartupSettings& settings, StartupState& state, double seconds,
                          const std::function<void(ImuSample&, double)>& alter) {
  auto last = startup::Progress::none;
  for (int i = 0; i <= static_cast<int>(std::lround(seconds * 100.0)); ++i) {
    ImuSample imu = test::imu_on(test::Truth{}, EngineDriver::stamp(0.01 * i));
    alter(imu, 0.01 * i);
    const auto progress = startup::update(settings, state, imu);
    if (progress != startup::Progress::none) last = progress;
  }
  return last;
}

TEST_CASE("at rest the offset is the mean rate over the set time") {
  StartupState state;
  const auto offset = [](ImuSample& imu, double) { imu.angular_velocity_body_radps += offset_radps; };
  CHECK(run_for(StartupSettings{}, state, 0.95, offset) == startup::Progress::none);
  CHECK(state.waiting);
  state = {};
  CHECK(run_for(StartupSettings{}, state, 1.0, offset) == startup::Progress::calibrated);
  CHECK((state.gyro_offset_body_radps - offset_radps).norm() < 1e-12);
  CHECK_FALSE(state.waiting);
}

TEST_CASE("a body that turns, rocks or shakes is not at rest") {
  const auto progress_with = [](const std::function<void(ImuSample&, double)>& alter) {
    StartupState state;
    return run_for(StartupSettings{}, state, 1.0, alter);
  };
  CHECK(progress_with([](ImuSample& imu, double) { imu.angular_velocity_body_radps.z() = 0.3; }) ==
        startup::Progress::gave_up);
  CHECK(progress_with(rock) == startup::Progress::gave_up);
  CHECK(progress_with([](ImuSample& imu, double t) {
          imu.specific_force_body_mps2.x() = std::sin(20.0 * t);
        }) == startup::Progress::gave_up);
}

TEST_CASE("a few samples are no calibration, over any time") {
  StartupState state;
  for (int i = 0; i < 5; ++i) {
    const ImuSample imu = test::imu_on(test::Truth{}, EngineDriver::stamp(1.0 * i));
    CHECK(startup::update(StartupSettings{}, state, imu) == startup::Progress::none);
  }
}

TEST_CASE("a start at rest calibrates, levels and sets the status") {
  EngineDriver driver(Settings{}, test::at_rest({3, 4, 1}), offset_sensors());
  const auto early = driver.run(0.5);
  CHECK(early.has(status_initialising));
  const auto late = driver.run(2.5);
  CHECK_FALSE(late.has(status_initialising));
  CHECK_FALSE(late.has(status_uncalibrated));
  CHECK((late.pose.gyro_bias_body_radps - offset_radps).norm() < 1e-3);
  CHECK(late.pose.angular_velocity_body_radps.norm() < 1e-3);
  CHECK(late.position_error_m() < 0.005);
  CHECK(late.pose.velocity_world_mps.norm() < 0.01);
}

TEST_CASE("a start in motion uses zero bias and the status uncalibrated") {
  test::Sensors sensors = offset_sensors();
  sensors.noise_m = 0.01;
  EngineDriver driver(Settings{}, test::at_rest(), sensors);
  driver.alter_imu = rock;
  const auto moment = driver.run(1.5);
  CHECK(moment.has(status_uncalibrated));
  CHECK_FALSE(moment.has(status_initialising));
  CHECK(driver.engine.state().startup.gyro_offset_body_radps.norm() == 0.0);

  WHEN("it comes to rest later") {
    driver.alter_imu = nullptr;
    const auto rested = driver.run(2.5);
    THEN("the offset is taken then") {
      CHECK_FALSE(rested.has(status_uncalibrated));
      CHECK((rested.pose.gyro_bias_body_radps - offset_radps).norm() < 2e-3);
    }
  }
}

TEST_CASE("constant velocity equals rest for an IMU: the fixes distinguish them") {
  for (const double speed_mps : {0.5, 2.0, 10.0}) {
    INFO("speed " << speed_mps);
    EngineDriver driver(Settings{}, test::constant_velocity(speed_mps));
    driver.run(6.0);
    CHECK(driver.moments.back().has(status_uncalibrated));
    CHECK(driver.moments.back().pose.velocity_world_mps.x() == Approx(speed_mps));
    CHECK(test::worst_error_m(driver.moments, 3.0) < 0.02);
  }
}

TEST_CASE("fixes whose height scatters by half a metre do not hide a rest") {
  EngineDriver driver(Settings{}, test::at_rest());
  std::mt19937 random(5);
  std::normal_distribution<double> noise_m(0.0, 0.5);
  driver.alter_fix = [&](UltrasonicFix& fix, double) { fix.position_world_m.z() += noise_m(random); };
  const auto moment = driver.run(1.5);
  CHECK_FALSE(moment.has(status_uncalibrated));
  CHECK(std::abs(moment.pose.velocity_world_mps.z()) < 0.2);
}

TEST_CASE("a late calibration does not subtract an offset twice") {
  // The paired heading teaches a yaw-rate offset while the body rocks; the later rest measures the same one.
  test::Sensors sensors;
  sensors.headings = true;
  sensors.noise_m = 0.01;
  sensors.gyro_offset_body_radps = {0, 0, 0.02};
  EngineDriver driver(Settings{}, test::at_rest(), sensors);
  driver.alter_imu = rock;
  driver.run(60.0);
  REQUIRE(driver.engine.state().heading.rate_offset_radps < -0.005);
  driver.alter_imu = nullptr;
  driver.run(3.0);
  driver.fixes_on = false;  // also stops the headings
  driver.run(1.0);
  const double yaw_before = geometry::yaw_of(driver.moments.back().pose.q_body_to_world);
  driver.run(10.0);
  const double drift_rad = geometry::yaw_of(driver.moments.back().pose.q_body_to_world) - yaw_before;
  CHECK(std::abs(drift_rad) < 0.02);
}

TEST_CASE("a tilted mounting is levelled from the first rest") {
  const Quaterniond q_mount = geometry::rotation_by({0.5, -0.3, 0.0});
  EngineDriver driver(Settings{}, test::at_rest());
  driver.alter_imu = [&q_mount](ImuSample& imu, double) {
    imu.specific_force_body_mps2 = q_mount.conjugate() * Vector3d(0, 0, test::gravity_mps2);
  };
  const auto moment = driver.run(1.5);
  const Vector3d up_body = q_mount.conjugate() * Vector3d::UnitZ();
  CHECK((geometry::up_in_body(moment.pose.q_body_to_world) - up_body).norm() < 1e-6);
  CHECK(moment.pose.acceleration_world_mps2.norm() < 1e-5);
}

TEST_CASE("after a start at rest the velocity is known at the first fix") {
  test::Sensors sensors;
  sensors.noise_m = 0.02;  // two fixes 80 ms apart would yield velocities of 0.35 m/s
  for (const double first_fix_s : {0.0, 0.8, 0.86, 1.5}) {
    EngineDriver driver(Settings{}, test::at_rest(), sensors);
    driver.fixes_on = false;
    if (first_fix_s > 0.0) driver.run(first_fix_s);
    driver.fixes_on = true;
    driver.run(3.0);
    double fastest_mps = 0.0;
    for (const auto& moment : driver.moments) {
      if (moment.time_s > 1.0) fastest_mps = std::max(fastest_mps, moment.pose.velocity_world_mps.norm());
    }
    INFO("first fix after " << first_fix_s << " s");
    CHECK(fastest_mps < 0.2);
  }
}

TEST_CASE("a body that left its rest long before the first fix has an unknown velocity") {
  EngineDriver driver(Settings{}, test::departure(5.0));
  driver.fixes_on = false;
  driver.run(12.0);
  driver.fixes_on = true;
  const auto moment = driver.run(0.4);
  CHECK(moment.pose.velocity_world_mps.x() == Approx(5.0).epsilon(0.02));
  CHECK(moment.position_error_m() < 0.05);
}

}  // namespace startup_test
