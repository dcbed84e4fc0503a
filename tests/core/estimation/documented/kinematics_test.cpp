/// Current corrections applied to the past.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace kinematics_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::epoch_ns;

TEST_CASE("the displacement between two past moments is the IMU's with the present corrections") {
  auto body = test::moving_body({2, 0, 0});
  const TimeNs from_ns = epoch_ns - to_ns(0.3);
  const TimeNs to_now_ns = epoch_ns - to_ns(0.1);
  REQUIRE(body.displacement_between(from_ns, to_now_ns).has_value());
  CHECK((*body.displacement_between(from_ns, to_now_ns) - Vector3d(0.4, 0, 0)).norm() < 1e-9);
  body.correct_velocity({0, 1, 0});
  CHECK((body.velocity_world_mps - Vector3d(2, 1, 0)).norm() < 1e-15);
  CHECK((*body.displacement_between(from_ns, to_now_ns) - Vector3d(0.4, 0.2, 0)).norm() < 1e-9);
  CHECK((*body.displacement_between(to_now_ns, from_ns) + Vector3d(0.4, 0.2, 0)).norm() < 1e-9);
}

TEST_CASE("beyond the newest sample the present velocity applies") {
  // The IMU alone yields −5 m/s, corrected by the fixes: the body stands still.
  auto body = test::moving_body({-5, 0, 0});
  body.correct_velocity({5, 0, 0});
  REQUIRE(body.velocity_world_mps.norm() < 1e-12);
  const TimeNs ahead_ns = epoch_ns + to_ns(0.02);
  REQUIRE(body.displacement_between(epoch_ns, ahead_ns).has_value());
  CHECK(body.displacement_between(epoch_ns, ahead_ns)->norm() < 1e-9);
  CHECK(body.displacement_between(ahead_ns, epoch_ns)->norm() < 1e-9);
  CHECK(body.displacement_between(epoch_ns - to_ns(0.1), ahead_ns)->norm() < 1e-9);
  body.correct_velocity({1, 0, 0});
  CHECK((*body.displacement_between(epoch_ns, ahead_ns) - Vector3d(0.02, 0, 0)).norm() < 1e-9);
}

TEST_CASE("a moment before the history is unknown") {
  const auto body = test::moving_body({2, 0, 0});
  CHECK_FALSE(body.displacement_between(epoch_ns - to_ns(1.5), epoch_ns).has_value());
  CHECK_FALSE(body.yaw_at(epoch_ns - to_ns(1.5)).has_value());
  CHECK_FALSE(Kinematics{}.displacement_between(1, 2).has_value());
}

TEST_CASE("yaw in the past includes the present corrections") {
  auto body = test::moving_body(Vector3d::Zero(), epoch_ns, 3.0);
  body.yaw_corrections_rad = 0.5;
  REQUIRE(body.yaw_at(epoch_ns - to_ns(0.1)).has_value());
  CHECK(*body.yaw_at(epoch_ns - to_ns(0.1)) == Approx(3.5 - 2.0 * M_PI));
}

TEST_CASE("the inertial path is independent of the velocity corrections") {
  // A constant accelerometer error of 0.2 m/s² bends the inertial path; the fixes compensate it.
  test::Sensors sensors;
  sensors.accel_offset_body_mps2 = {0.2, 0, 0};
  test::EngineDriver driver(Settings{}, test::departure(2.0), sensors);
  // The error starts after the start-up calibration, which would take it for tilt.
  driver.alter_imu = [](ImuSample& imu, double time_s) {
    if (time_s < 2.0) imu.specific_force_body_mps2.x() -= 0.2;
  };
  driver.run(20.0);
  const auto& body = driver.engine.state().body;
  const auto moved = body.displacement_between(body.time_ns - to_ns(0.2), body.time_ns);
  REQUIRE(moved.has_value());
  CHECK(moved->x() == Approx(0.4).epsilon(0.1));
  CHECK(body.velocity_world_mps.x() == Approx(2.0).epsilon(0.1));
}

}  // namespace kinematics_test
