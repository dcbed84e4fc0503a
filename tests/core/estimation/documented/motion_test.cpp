/// Motion limits (items 25 and 35–37) and the integration itself.

#include <sonopose/estimation/documented/motion.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace motion_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

MotionSettings plain() {
  MotionSettings settings;
  settings.gyro_gate_projection_radps = 4.0;
  settings.gyro_gate_freeze_radps = 7.0;
  settings.accel_linear_threshold_mps2 = 30.0;
  return settings;
}

Kinematics turning_body(double rate_radps, const Vector3d& velocity_world_mps) {
  Kinematics body;
  body.velocity_world_mps = velocity_world_mps;
  body.angular_velocity_body_radps = rate_radps * Vector3d(1, -2, 2) / 3.0;
  return body;
}

TEST_CASE("the strapdown equations are exact for constant acceleration") {
  Kinematics body;
  body.position_world_m = {1, 0, 0};
  body.velocity_world_mps = {2, 0, 0};
  const Vector3d a(0.5, -1.0, 0.25);
  for (int i = 0; i < 200; ++i) motion::integrate(plain(), body, a, 0.01);
  CHECK((body.velocity_world_mps - Vector3d(2, 0, 0) - 2.0 * a).norm() < 1e-10);
  CHECK((body.position_world_m - Vector3d(5, 0, 0) - 0.5 * a * 4.0).norm() < 1e-10);
}

TEST_CASE("item 36: below the threshold the acceleration is integrated in full") {
  const Vector3d a(1, 2, 3);
  CHECK(motion::gate(plain(), turning_body(3.99, {5, 0, 0}), a) == a);
  CHECK_FALSE(motion::is_gated(plain(), turning_body(3.99, {5, 0, 0})));
}

TEST_CASE("item 36: above it only the part along the velocity") {
  const auto body = turning_body(4.01, {3, 4, 0});
  CHECK(motion::is_gated(plain(), body));
  CHECK((motion::gate(plain(), body, {3, 4, 9}) - Vector3d(3, 4, 0)).norm() < 1e-12);
  CHECK(motion::gate(plain(), body, {-4, 3, 2}).norm() <
        1e-12);  // centrifugal: perpendicular to the velocity
  CHECK((motion::gate(plain(), body, {-3, -4, 0}) - Vector3d(-3, -4, 0)).norm() < 1e-12);  // braking
}

TEST_CASE("item 36: a body that stands has no direction to project on") {
  CHECK(motion::gate(plain(), turning_body(5.0, Vector3d::Zero()), {1, 2, 3}).norm() == 0.0);
}

TEST_CASE("item 37: above the freeze rate nothing is integrated") {
  CHECK((motion::gate(plain(), turning_body(6.99, {5, 0, 0}), {1, 0, 0}) - Vector3d(1, 0, 0)).norm() < 1e-12);
  CHECK(motion::gate(plain(), turning_body(7.01, {5, 0, 0}), {1, 2, 3}).norm() == 0.0);
}

TEST_CASE("item 37 lies below the rate at which the beacon's gyro clips") {
  CHECK(MotionSettings{}.gyro_gate_freeze_radps < 10.0);
  CHECK(MotionSettings{}.gyro_gate_projection_radps < MotionSettings{}.gyro_gate_freeze_radps);
}

TEST_CASE("item 35 off: no rate holds anything back") {
  MotionSettings off = plain();
  off.gyro_gate = false;
  CHECK(motion::gate(off, turning_body(50.0, {5, 0, 0}), {1, 2, 3}) == Vector3d(1, 2, 3));
  CHECK_FALSE(motion::is_gated(off, turning_body(50.0, {5, 0, 0})));
}

TEST_CASE("item 25: the velocity is softly limited above the threshold and never below") {
  const auto speed_after_a_second = [](double acceleration_mps2) {
    Kinematics body;
    body.velocity_world_mps = {5, 0, 0};
    body.acceleration_world_mps2 = {0, 0, acceleration_mps2};
    for (int i = 0; i < 100; ++i) motion::integrate(plain(), body, Vector3d::Zero(), 0.01);
    return body.velocity_world_mps.x();
  };
  CHECK(speed_after_a_second(29.9) == 5.0);
  CHECK(speed_after_a_second(30.0) == 5.0);
  const double little = speed_after_a_second(33.0);
  const double more = speed_after_a_second(60.0);
  CHECK(little < 5.0);
  CHECK(little > 4.0);  // a soft limit
  CHECK(more < little);
  CHECK(more > 0.0);
}

TEST_CASE("items 35–37, in the engine: spinning with the IMU off the centre does not run away") {
  // 0.5 m off the centre of rotation at 9 rad/s: 40 m/s² of centripetal acceleration at a point at rest.
  const auto worst_m = [](bool gate) {
    Settings settings;
    settings.motion.gyro_gate = gate;
    test::EngineDriver driver(settings, test::at_rest());
    driver.alter_imu = [](ImuSample& imu, double time_s) {
      if (time_s < 4.0 || time_s > 5.0) return;
      imu.angular_velocity_body_radps.z() = 9.0;
      imu.specific_force_body_mps2.x() = -81.0 * 0.5;
    };
    driver.run(3.9);
    driver.fixes_on = false;
    bool reported = false;
    driver.run(0.8);
    for (const auto& moment : driver.moments) reported = reported || moment.has(status_rotating_fast);
    CHECK(reported == gate);
    return test::worst_error_m(driver.moments, 3.9);
  };
  CHECK(worst_m(true) < 0.05);
  CHECK(worst_m(false) > 0.5);
}

}  // namespace motion_test
