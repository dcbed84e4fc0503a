#include "evaluation/replay/strapdown.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace strapdown_test {

using namespace sonopose;
using namespace sonopose::evaluation::strapdown;

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// A body that flies a tilted helix while it rolls and yaws, in closed form.
struct Helix {
  static constexpr double turn_radps = 1.3;
  static constexpr double roll_radps = 0.7;
  static constexpr double radius_m = 2.0;
  static constexpr double climb_mps = 0.25;

  static Quaterniond attitude(double t) {
    return geometry::rotation_about_z(turn_radps * t) * geometry::rotation_by({roll_radps * t, 0, 0});
  }
  static State state(double t) {
    const double angle = turn_radps * t;
    return {start_ns + to_ns(t),
            {radius_m * std::cos(angle), radius_m * std::sin(angle), climb_mps * t},
            {-radius_m * turn_radps * std::sin(angle), radius_m * turn_radps * std::cos(angle), climb_mps},
            attitude(t)};
  }
  static ImuSample imu(double t) {
    const double angle = turn_radps * t;
    const double inward = -radius_m * turn_radps * turn_radps;
    const Vector3d force_world(inward * std::cos(angle), inward * std::sin(angle), standard_gravity_mps2);
    ImuSample sample;
    sample.sensor_time_ns = start_ns + to_ns(t);
    sample.specific_force_body_mps2 = attitude(t).conjugate() * force_world;
    // The turn about world Z as seen from the rolled body, plus the roll about its own X.
    sample.angular_velocity_body_radps =
        Vector3d(roll_radps, 0, 0) + attitude(t).conjugate() * Vector3d(0, 0, turn_radps);
    return sample;
  }
};

State after(double duration_s, double step_s, Rule rule) {
  Integrator strapdown({}, Helix::state(0.0), rule);
  const int steps = static_cast<int>(std::lround(duration_s / step_s));
  for (int k = 0; k <= steps; ++k) strapdown.predict(Helix::imu(k * step_s));
  return strapdown.state();
}

/// Order of convergence: log2 of the ratio of the errors when the step is halved.
double position_order(Rule rule) {
  const auto error_m = [rule](double step_s) {
    return (after(8.0, step_s, rule).position_world_m - Helix::state(8.0).position_world_m).norm();
  };
  return std::log2(error_m(1.0 / 256) / error_m(1.0 / 512));
}

double angle_order(Rule rule) {
  const auto error_rad = [rule](double step_s) {
    return after(8.0, step_s, rule).q_body_to_world.angularDistance(Helix::attitude(8.0));
  };
  return std::log2(error_rad(1.0 / 256) / error_rad(1.0 / 512));
}

TEST_CASE("an ideal IMU's integral returns to the truth") {
  const State truth = Helix::state(8.0);
  const State mean = after(8.0, 1e-3, Rule::mean);
  CHECK(mean.time_ns == truth.time_ns);
  CHECK((mean.position_world_m - truth.position_world_m).norm() < 1e-4);
  CHECK((mean.velocity_world_mps - truth.velocity_world_mps).norm() < 1e-4);
  CHECK(mean.q_body_to_world.angularDistance(truth.q_body_to_world) < 1e-5);
  const State previous = after(8.0, 1e-3, Rule::previous);
  CHECK((previous.position_world_m - truth.position_world_m).norm() < 0.2);  // half a step late throughout
}

TEST_CASE("the document's rule is of first order in the step, the mean rule of second") {
  CHECK(position_order(Rule::previous) == Approx(1.0).margin(0.1));
  CHECK(angle_order(Rule::previous) == Approx(1.0).margin(0.1));
  CHECK(position_order(Rule::mean) >= 1.9);
  CHECK(angle_order(Rule::mean) >= 1.9);
}

TEST_CASE("one step is the document's equations 1 to 4 with the values of sample k-1") {
  // Level, facing world Y, at 2 m/s along X; accelerated forwards by 1 m/s² and turning left at 1 rad/s.
  const double quarter = std::numbers::pi / 2;
  Integrator strapdown({}, {start_ns, {1, 2, 3}, {2, 0, 0}, geometry::rotation_about_z(quarter)},
                       Rule::previous);
  ImuSample imu;
  imu.sensor_time_ns = start_ns;
  imu.specific_force_body_mps2 = {1, 0, standard_gravity_mps2};
  imu.angular_velocity_body_radps = {0, 0, 1};
  strapdown.predict(imu);
  CHECK(strapdown.state().position_world_m == Vector3d(1, 2, 3));  // no time has passed
  ImuSample next = imu;
  next.sensor_time_ns = start_ns + to_ns(0.5);
  next.specific_force_body_mps2 = {77, 77, 77};  // takes effect from here on
  next.angular_velocity_body_radps = {7, 7, 7};
  strapdown.predict(next);
  const auto& state = strapdown.state();
  CHECK(state.position_world_m.isApprox(Vector3d(2, 2.125, 3), 1e-12));
  CHECK(state.velocity_world_mps.isApprox(Vector3d(2, 0.5, 0), 1e-12));
  CHECK(geometry::yaw_of(state.q_body_to_world) == Approx(quarter + 0.5));
}

TEST_CASE("the increment stands on the right: a tilted body turns about its own axis") {
  // Nose straight down: body X is world −Z. A roll about body X turns it about the vertical.
  const Quaterniond nose_down = geometry::rotation_by({0, std::numbers::pi / 2, 0});
  Integrator strapdown({}, {start_ns, {0, 0, 0}, {0, 0, 0}, nose_down}, Rule::previous);
  ImuSample imu;
  imu.sensor_time_ns = start_ns + to_ns(1.0);
  imu.specific_force_body_mps2 = {0, 0, 1};
  imu.angular_velocity_body_radps = {0.3, 0, 0};
  strapdown.predict(imu);
  const Quaterniond expected = geometry::rotation_by({0, 0, -0.3}) * nose_down;
  CHECK(strapdown.state().q_body_to_world.angularDistance(expected) < 1e-12);
}

TEST_CASE("the first step begins at the start, not at the sample before it") {
  Integrator strapdown({}, {start_ns, {0, 0, 0}, {1, 0, 0}, Quaterniond::Identity()}, Rule::previous);
  ImuSample imu;
  imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
  imu.sensor_time_ns = start_ns - to_ns(0.006);
  strapdown.predict(imu);
  CHECK(strapdown.state().time_ns == start_ns);
  imu.sensor_time_ns = start_ns + to_ns(0.004);
  strapdown.predict(imu);
  CHECK(strapdown.state().position_world_m.x() == Approx(0.004));
}

}  // namespace strapdown_test
