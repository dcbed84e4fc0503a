/// The engine under invalid input: broken values, wrong times and shared stamps.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace engine_input_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::EngineDriver;

TEST_CASE("a fix before any IMU sample does no harm, even with a wrong time") {
  for (const double off_s : {0.0, -1e6, 1e6}) {
    INFO("off by " << off_s << " s");
    EngineDriver driver(Settings{}, test::at_rest({1, 1, 1}));
    UltrasonicFix early;
    early.emission_time_ns = test::epoch_ns + to_ns(off_s) - to_ns(0.1);
    early.received_time_ns = early.emission_time_ns + to_ns(0.068);
    early.position_world_m = {1, 1, 1};
    driver.engine.correct(early);
    PairHeading heading{7, 2, early.emission_time_ns, early.received_time_ns, 0.5, true};
    driver.engine.correct(heading);
    const auto later = driver.run(3.0);
    CHECK(later.pose.status == status_heading_unknown);
    CHECK(later.position_error_m() < 0.01);
  }
}

TEST_CASE("delay.source = fixed: an impossible recorded delay has no effect") {
  Settings settings;
  settings.delay.source = DelaySource::fixed;
  for (const double wrong_by_s : {-2.0, 0.1}) {
    EngineDriver driver(settings, test::departure(3.0));
    driver.alter_fix = [wrong_by_s](UltrasonicFix& fix, double) {
      fix.emission_time_ns += to_ns(wrong_by_s);
      fix.measured_delay_s = seconds_between(fix.emission_time_ns, fix.received_time_ns);
    };
    driver.run(10.0);
    CHECK(driver.engine.counters().fixes_rejected == 0);
    CHECK(driver.moments.back().position_error_m() < 0.03);
  }
}

TEST_CASE("21 samples with the same stamp are no duplicates") {
  test::Sensors sensors = test::with_headings();
  sensors.imu_rate_hz = 1000.0;
  EngineDriver driver(Settings{}, test::departure(1.0), sensors);
  driver.alter_imu = [](ImuSample& imu, double time_s) {
    imu.sensor_time_ns = EngineDriver::stamp(0.021 * std::floor(time_s / 0.021 + 1e-9));
  };
  driver.run(20.0);
  CHECK(driver.engine.counters().samples_invalid == 0);
  CHECK(driver.engine.counters().imu_gaps == 0);
  CHECK(driver.moments.size() == 20'000);
  // The stamp is up to 21 ms old, which is 2 cm at 1 m/s.
  const auto& last = driver.moments.back();
  CHECK(last.pose.time_ns == EngineDriver::stamp(0.021 * std::floor(19.999 / 0.021)));
  CHECK(last.pose.velocity_world_mps.norm() == Approx(1.0).epsilon(0.05));
  CHECK(last.position_error_m() < 0.021 + 0.02);
}

TEST_CASE("with shared stamps the rates still integrate to the whole angle") {
  Settings settings;
  settings.attitude.selection.filter = attitude::FilterKind::gyro;
  Engine engine(settings);
  test::Truth turning;
  turning.yaw_rate_radps = 0.5;
  std::optional<FusedPose> pose;
  for (int burst = 0; burst <= 100; ++burst) {
    for (int i = 0; i < 21; ++i) {
      pose = engine.predict(test::imu_on(turning, EngineDriver::stamp(0.021 * burst)));
      REQUIRE(pose.has_value());
    }
  }
  CHECK(geometry::yaw_of(pose->q_body_to_world) == Approx(0.5 * 2.1).epsilon(1e-3));
}

TEST_CASE("millisecond stamps cause no error beyond their rounding") {
  EngineDriver fine(Settings{}, test::departure(3.0, 0.1), test::with_headings());
  EngineDriver rounded(Settings{}, test::departure(3.0, 0.1), test::with_headings());
  const auto bursts = [](ImuSample& imu, double time_s) {
    imu.sensor_time_ns = EngineDriver::stamp(0.02 * std::floor(time_s / 0.02 + 1e-9));
  };
  rounded.alter_imu = bursts;  // pairs share a stamp, at most 10 ms off
  fine.run(12.0);
  rounded.run(12.0);
  CHECK((fine.moments.back().pose.position_world_m - rounded.moments.back().pose.position_world_m).norm() <
        3.0 * 0.01 + 0.02);
}

}  // namespace engine_input_test
