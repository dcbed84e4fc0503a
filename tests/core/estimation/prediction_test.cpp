/// Poses predicted between IMU samples.

#include <sonopose/estimation/prediction.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace prediction_test {

using namespace sonopose;
using namespace sonopose::estimation;

constexpr TimeNs ms_ns = 1'000'000;

/// Pose on a circle of radius 2 m about the origin at 1 rad/s, counter-clockwise, nose forwards.
FusedPose on_circle(double angle_rad) {
  FusedPose pose;
  pose.address = 7;
  pose.sequence = 12;
  pose.time_ns = 1'700'000'000'000'000'000 + to_ns(angle_rad);
  pose.position_world_m = 2.0 * Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  pose.velocity_world_mps = 2.0 * Vector3d(-std::sin(angle_rad), std::cos(angle_rad), 0.0);
  pose.acceleration_world_mps2 = -pose.position_world_m;
  pose.angular_velocity_body_radps = Vector3d(0.0, 0.0, 1.0);
  pose.q_body_to_world = geometry::rotation_about_z(angle_rad + geometry::radians_per_degree * 90.0);
  return pose;
}

SCENARIO("a pose between samples continues the motion") {
  GIVEN("a body on a circle") {
    const FusedPose at_sample = on_circle(0.3);
    WHEN("it is asked for 8 ms after a sample") {
      const FusedPose between = predicted(at_sample, 8 * ms_ns);
      const FusedPose truth = on_circle(0.308);
      THEN("it is where the body is by then, but for what the change of acceleration does") {
        // |jerk| is 2 m/s³: over 8 ms, jerk·t³/6 = 0.17 µm and jerk·t²/2 = 64 µm/s.
        CHECK((between.position_world_m - truth.position_world_m).norm() < 0.2e-6);
        CHECK((between.velocity_world_mps - truth.velocity_world_mps).norm() < 70e-6);
        CHECK(between.q_body_to_world.angularDistance(truth.q_body_to_world) < 1e-9);
        CHECK(between.time_ns == at_sample.time_ns + 8 * ms_ns);
      }
      THEN("it says that it is predicted, and from which sample") {
        CHECK(between.status == (at_sample.status | status_predicted));
        CHECK(between.sequence == at_sample.sequence);
        CHECK(between.imu_sensor_time_ns == at_sample.imu_sensor_time_ns);
      }
    }
  }
}

SCENARIO("a pose that ignores acceleration is predicted without it") {
  for (const auto status : {status_stale, status_initialising, status_rotating_fast}) {
    FusedPose at_sample = on_circle(0.0);
    at_sample.status = status;
    const FusedPose later = predicted(at_sample, 50 * ms_ns);
    CHECK(later.velocity_world_mps == at_sample.velocity_world_mps);
    CHECK(later.position_world_m.y() == Approx(0.1));
    CHECK(later.position_world_m.x() == 2.0);
  }
}

SCENARIO("a predicted pose has a larger standard deviation") {
  FusedPose at_sample = on_circle(0.0);
  at_sample.pose_covariance.set(0, 0, 0.03 * 0.03);
  at_sample.pose_covariance.set(1, 1, 0.03 * 0.03);
  at_sample.velocity_covariance = Covariance<3>::from_diagonal({0.16, 0.0, 0.16});
  at_sample.since_valid_fix_s = 0.05;
  const FusedPose later = predicted(at_sample, 100 * ms_ns);
  CHECK(position_std_m(later).x() == Approx(0.05));  // 3 cm and 4 cm, independent
  CHECK(position_std_m(later).y() == 0.03);
  CHECK(later.since_valid_fix_s == Approx(0.15));
}

TEST_CASE("the period is the inverse of the rate, and 0 without one") {
  settings::Settings settings;
  CHECK(prediction_period_ns(settings.output) == 0);
  settings.output.rate_hz = 1000;
  CHECK(prediction_period_ns(settings.output) == ms_ns);
}

}  // namespace prediction_test
