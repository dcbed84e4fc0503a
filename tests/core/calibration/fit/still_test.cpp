#include "calibration/fit/still.hpp"

#include "calibration/simulated_sensor.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace still_test {

using namespace sonopose;
using namespace sonopose::calibration;
using namespace sonopose::calibration::fit;
using namespace sonopose::test;

TEST_CASE("GIVEN a sensor held still in 14 orientations THEN each is found, without the turns between") {
  SensorErrors errors;
  errors.gyro_offset_radps = {0.02, -0.03, 0.01};
  const auto directions = sides_and_corners_of_a_cube();
  const auto imu = SimulatedSensor(errors, 1).hold_in_turn(directions);
  const auto intervals = find_still_intervals(imu);
  REQUIRE(intervals.size() == directions.size());
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    // Period i lasts from 3·i s to 3·i + 2 s at 100 Hz.
    CHECK(intervals[i].begin >= 300 * i);
    CHECK(intervals[i].end <= 300 * i + 200);
    CHECK(intervals[i].count() >= 120);
    CHECK((intervals[i].mean_force_mps2 - standard_gravity_mps2 * directions[i]).norm() < 0.01);
    CHECK((intervals[i].mean_rate_radps - errors.gyro_offset_radps).norm() < 0.001);
  }
  CHECK(count_orientations(intervals, 0.15) == 14);
}

TEST_CASE("noisier and quieter sensors set their own thresholds") {
  for (const double factor : {0.0, 0.1, 1.0, 5.0}) {
    CAPTURE(factor);
    SensorErrors errors;
    errors.gyro_noise_radps *= factor;
    errors.accel_noise_mps2 *= factor;
    const auto imu = SimulatedSensor(errors, 2).hold_in_turn(sides_of_a_cube());
    CHECK(find_still_intervals(imu).size() == 6);
  }
}

TEST_CASE("a sensor that is always in motion is never still") {
  SimulatedSensor sensor(SensorErrors{}, 3);
  Quaterniond q = Quaterniond::Identity();
  for (int i = 0; i < 20; ++i) {
    const Quaterniond next = q * geometry::rotation_by(Vector3d(1.0, i % 3 - 1.0, 0.5));
    sensor.turn(q, next);
    q = next;
  }
  CHECK(find_still_intervals(sensor.samples()).empty());
  CHECK(find_still_intervals({}).empty());
}

TEST_CASE("a slow steady turn beside rest is not still") {
  SimulatedSensor sensor(SensorErrors{}, 4);
  sensor.hold(Quaterniond::Identity(), 10.0);
  auto imu = sensor.samples();
  for (std::size_t k = 600; k < imu.size(); ++k) imu[k].angular_velocity_body_radps.z() += 0.05;
  const auto intervals = find_still_intervals(imu);
  REQUIRE(intervals.size() == 1);
  CHECK(intervals.front().end <= 600);
}

TEST_CASE("a gap in the stamps and a number that is none end a period") {
  SimulatedSensor sensor(SensorErrors{}, 5);
  sensor.hold(Quaterniond::Identity(), 10.0);
  auto imu = sensor.samples();
  SECTION("gap") {
    for (std::size_t k = 500; k < imu.size(); ++k) imu[k].sensor_time_ns += to_ns(5.0);
  }
  SECTION("not a number") {
    imu[500].specific_force_body_mps2.x() = std::numeric_limits<double>::quiet_NaN();
  }
  const auto intervals = find_still_intervals(imu);
  REQUIRE(intervals.size() == 2);
  CHECK(intervals[0].end <= 500);
  CHECK(intervals[1].begin >= 500);
  CHECK(intervals[1].mean_force_mps2.allFinite());
}

TEST_CASE("the same orientation twice counts once") {
  const auto imu =
      SimulatedSensor(SensorErrors{}, 6).hold_in_turn({{0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {0.1, 0, 1}});
  const auto intervals = find_still_intervals(imu);
  REQUIRE(intervals.size() >= 3);
  CHECK(count_orientations(intervals, 0.15) == 2);
}

}  // namespace still_test
