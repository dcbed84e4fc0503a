/// The equations of a measured velocity against numerical derivatives.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace velocity_correction_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

const Vector3d place_body_m(0.4, -0.2, 0.1);

Filter moving_filter() {
  Filter filter;
  filter.velocity_world_mps = {1.2, -0.7, 0.3};
  filter.q_body_to_world = geometry::rotation_by(Vector3d(0.2, -0.3, 1.1));
  filter.angular_velocity_body_radps = {0.3, -0.2, 0.8};
  filter.lever_arm_body_m = {0.05, 0.02, -0.03};
  filter.covariance = 1e-6 * StateCovariance::Identity();
  filter.scale.push({.error = 0.02, .variance = 1e-6});
  return filter;
}

/// Velocity that the filter predicts along this axis.
double predicted_mps(const Filter& filter, int axis) {
  return -filter.velocity_innovation(axis, 0.0, 1.0, place_body_m, true, 0.0).value_mps;
}

SCENARIO("a measured velocity") {
  GIVEN("a filter in motion whose velocity is well known") {
    const Filter filter = moving_filter();
    const int axis = GENERATE(0, 1, 2);
    THEN("it is that of its place on the rigid body, times the scale") {
      const Vector3d body_mps =
          filter.q_body_to_world.conjugate() * filter.velocity_world_mps +
          filter.angular_velocity_body_radps.cross(place_body_m - filter.lever_arm_body_m);
      CHECK(predicted_mps(filter, axis) == Approx(1.02 * body_mps[axis]));
    }
    THEN("P Hᵀ has the derivatives with respect to the state and the scale") {
      constexpr double size = 1e-6;
      const auto innovation = filter.velocity_innovation(axis, 0.0, 1.0, place_body_m, true, 0.0);
      for (const int row : {3, 4, 5, 6, 7, 8, 15, 16, 17}) {
        StateVector error = StateVector::Zero();
        error[row] = size;
        Filter moved = filter;
        moved.inject(error);
        const double derivative = (predicted_mps(moved, axis) - predicted_mps(filter, axis)) / size;
        CHECK(innovation.column[row] / 1e-6 == Approx(derivative).margin(1e-4));
      }
      Filter scaled = filter;
      (*scaled.scale).error += size;
      const double derivative = (predicted_mps(scaled, axis) - predicted_mps(filter, axis)) / size;
      CHECK(innovation.scale_row / 1e-6 == Approx(derivative).margin(1e-4));
      Filter turning = filter;  // the rate is the gyroscope's minus its bias
      turning.angular_velocity_body_radps.z() -= size;
      CHECK(innovation.column[at_gyro_bias + 2] / 1e-6 ==
            Approx((predicted_mps(turning, axis) - predicted_mps(filter, axis)) / size).margin(1e-4));
    }
  }
  GIVEN("a filter at rest whose velocity is uncertain") {
    Filter filter;
    filter.velocity_world_mps = {0.02, 0.03, -0.01};
    filter.covariance = 1e-2 * StateCovariance::Identity();
    THEN("it shows nothing of the attitude") {
      const auto innovation = filter.velocity_innovation(0, 0.02, 1e-3, Vector3d::Zero(), false, 0.0);
      CHECK(innovation.column.segment<3>(at_attitude).isZero());
    }
  }
  GIVEN("a body whose true speed fixes show, and wheels that read 4 % more") {
    Filter filter;
    filter.scale.push({.variance = 0.05 * 0.05});
    WHEN("both are used for a while") {
      constexpr double speed_mps = 1.5;
      filter.covariance = 1e-2 * StateCovariance::Identity();
      for (int i = 0; i < 200; ++i) {
        filter.add_variance(at_velocity, Vector3d::Constant(1e-3));
        filter.update_direct(at_velocity, Vector3d(speed_mps, 0, 0) - filter.velocity_world_mps, 1e-4);
        filter.correct_velocity(
            filter.velocity_innovation(0, 1.04 * speed_mps, 1e-3, Vector3d::Zero(), true, 0.0), 0.0);
      }
      THEN("the scale error is found, and its deviation covers the rest") {
        CHECK(filter.scale->error == Approx(0.04).margin(3.0 * std::sqrt(filter.scale->variance)));
        CHECK(std::sqrt(filter.scale->variance) < 0.01);
        CHECK(filter.velocity_world_mps.x() == Approx(speed_mps).margin(0.03));
      }
    }
  }
}

}  // namespace velocity_correction_test
