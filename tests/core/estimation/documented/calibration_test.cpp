/// Calibration inside the engine, applied once to the raw samples.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace calibration_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

/// Measurement of a sensor turned by 90° about Z in its housing, with offsets, and 2 % too sensitive along
/// its x.
ImuSample as_measured(ImuSample imu) {
  const auto in_sensor = [](const Vector3d& body) { return Vector3d(-body.y(), body.x(), body.z()); };
  imu.angular_velocity_body_radps = in_sensor(imu.angular_velocity_body_radps) + Vector3d(0.0, 0.01, 0.0);
  imu.specific_force_body_mps2 = in_sensor(imu.specific_force_body_mps2);
  imu.specific_force_body_mps2.x() *= 1.02;
  imu.specific_force_body_mps2 += Vector3d(0.3, -0.2, 0.1);
  return imu;
}

Settings settings_of_the_sensor() {
  Settings settings;
  set(settings, "calibration.axes", std::string("+y-x+z"));
  settings.calibration.gyroscope.offset_y_radps = 0.01;
  settings.calibration.accelerometer.sensitivity_x = 1.0 / 1.02;
  settings.calibration.accelerometer.offset_x_mps2 = 0.3;
  settings.calibration.accelerometer.offset_y_mps2 = -0.2;
  settings.calibration.accelerometer.offset_z_mps2 = 0.1;
  return settings;
}

TEST_CASE("a raw sensor and its calibration give the pose of an ideal one") {
  test::Sensors sensors;
  sensors.headings = true;
  const auto motion = test::departure(1.5, 0.3);
  test::EngineDriver ideal(Settings{}, motion, sensors);
  test::EngineDriver raw(settings_of_the_sensor(), motion, sensors);
  raw.alter_imu = [](ImuSample& imu, double) { imu = as_measured(imu); };
  const auto expected = ideal.run(12.0);
  const auto found = raw.run(12.0);
  CHECK((found.pose.position_world_m - expected.pose.position_world_m).norm() < 1e-9);
  CHECK(found.pose.q_body_to_world.angularDistance(expected.pose.q_body_to_world) < 1e-9);
  CHECK((found.pose.angular_velocity_body_radps - expected.pose.angular_velocity_body_radps).norm() < 1e-9);
  WHEN("the engine does not know the sensor") {
    test::EngineDriver unknown(Settings{}, motion, sensors);
    unknown.alter_imu = raw.alter_imu;
    THEN("the pose is another one") {
      CHECK((unknown.run(12.0).pose.velocity_world_mps - expected.pose.velocity_world_mps).norm() > 0.01);
    }
  }
}

TEST_CASE("another calibration applies to a running engine from the next sample on") {
  Engine engine{Settings{}};
  Settings settings;
  settings.calibration.accelerometer.offset_z_mps2 = 0.5;
  ImuSample imu;
  imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2 + 0.5};
  imu.sensor_time_ns = test::epoch_ns;
  CHECK(engine.predict(imu)->acceleration_world_mps2.z() == Approx(0.5).margin(1e-9));
  engine.configure(settings);
  imu.sensor_time_ns += 10'000'000;
  CHECK(engine.predict(imu)->acceleration_world_mps2.z() == Approx(0.0).margin(1e-9));
}

}  // namespace calibration_test
