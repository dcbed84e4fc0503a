/// The filter's equations against numerical derivatives, and its covariance over long random runs.

#include "support/seeds.hpp"
#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <random>

namespace kalman_filter_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

class Dice {
public:
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  Vector3d vector(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }

private:
  std::mt19937 engine_{7};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
};

Filter random_filter(Dice& dice) {
  Filter filter;
  filter.position_world_m = dice.vector(5.0);
  filter.velocity_world_mps = dice.vector(3.0);
  filter.q_body_to_world = geometry::rotation_by(dice.vector(1.5));
  filter.gyro_bias_body_radps = dice.vector(0.05);
  filter.accel_bias_body_mps2 = dice.vector(0.2);
  filter.lever_arm_body_m = dice.vector(0.1);
  filter.covariance = 1e-4 * StateCovariance::Identity();
  return filter;
}

/// Returns `filter` with `error` added to its state.
Filter moved_by(Filter filter, const StateVector& error) {
  filter.position_world_m += error.segment<3>(at_position);
  filter.velocity_world_mps += error.segment<3>(at_velocity);
  filter.q_body_to_world =
      filter.q_body_to_world * geometry::rotation_by(error.segment<3>(at_attitude).eval());
  filter.gyro_bias_body_radps += error.segment<3>(at_gyro_bias);
  filter.accel_bias_body_mps2 += error.segment<3>(at_accel_bias);
  filter.lever_arm_body_m += error.segment<3>(at_lever_arm);
  return filter;
}

StateVector difference(const Filter& a, const Filter& b) {
  StateVector error;
  error.segment<3>(at_position) = a.position_world_m - b.position_world_m;
  error.segment<3>(at_velocity) = a.velocity_world_mps - b.velocity_world_mps;
  const Eigen::AngleAxisd turn(b.q_body_to_world.conjugate() * a.q_body_to_world);
  error.segment<3>(at_attitude) = turn.angle() * turn.axis();
  error.segment<3>(at_gyro_bias) = a.gyro_bias_body_radps - b.gyro_bias_body_radps;
  error.segment<3>(at_accel_bias) = a.accel_bias_body_mps2 - b.accel_bias_body_mps2;
  error.segment<3>(at_lever_arm) = a.lever_arm_body_m - b.lever_arm_body_m;
  return error;
}

TEST_CASE("the composed transition is the derivative of the nominal state") {
  Dice dice;
  constexpr int steps = 4;
  constexpr double step_s = 0.01;
  constexpr double size = 1e-5;
  const Filter start = random_filter(dice);
  std::array<Vector3d, steps> rates;
  std::array<Vector3d, steps> forces;
  for (int i = 0; i < steps; ++i) {
    rates[static_cast<std::size_t>(i)] = dice.vector(2.0);
    forces[static_cast<std::size_t>(i)] = Vector3d(0, 0, 9.8) + dice.vector(3.0);
  }
  const auto run = [&](Filter filter) {
    for (std::size_t i = 0; i < steps; ++i) filter.predict(rates[i], forces[i], step_s);
    return filter;
  };
  const Filter end = run(start);
  const StateCovariance derivative = [&] {
    StateCovariance result;
    for (int i = 0; i < state_size; ++i) {
      const StateVector error = size * StateVector::Unit(i);
      result.col(i) = difference(run(moved_by(start, error)), run(moved_by(start, -error))) / (2.0 * size);
    }
    return result;
  }();

  // The transition matrix is of first order in the step.
  CHECK((end.transition() - derivative).cwiseAbs().maxCoeff() < 0.01);

  Filter propagated = end;
  propagated.covariance = start.covariance;
  propagated.propagate(
      {.accel_mps2_rthz = 0, .gyro_radps_rthz = 0, .accel_bias_mps2_rts = 0, .gyro_bias_radps_rts = 0});
  const StateCovariance expected = derivative * start.covariance * derivative.transpose();
  CHECK((propagated.covariance - expected).cwiseAbs().maxCoeff() < 0.01 * expected.cwiseAbs().maxCoeff());
}

TEST_CASE("a fix and a heading move the state as their derivatives demand") {
  Dice dice;
  for (int i = 0; i < 50; ++i) {
    Filter filter = random_filter(dice);
    filter.angular_velocity_body_radps = dice.vector(1.0);
    const Matrix3d noise = 1e-4 * Matrix3d::Identity();
    const Vector3d fix = filter.tracked_position_world_m() + dice.vector(0.01);
    const Innovation innovation_before = filter.fix_innovation(fix, noise, 0.0);
    Filter by_fix = filter;
    by_fix.correct_fix(innovation_before);
    const double before_m = innovation_before.value_world_m.norm();
    const double after_m = by_fix.fix_innovation(fix, noise, 0.0).value_world_m.norm();
    // Position, lever arm and fix have equal variances: a third remains, or less because tilt helps.
    CHECK(after_m < 0.34 * before_m);
    CHECK(after_m > 0.31 * before_m);

    const double yaw = geometry::yaw_of(filter.q_body_to_world) + 0.01;
    const auto innovation = filter.heading_innovation(yaw, 0.0, 1e-4, 0.0);
    if (!innovation.observable) continue;
    Filter by_heading = filter;
    by_heading.correct_heading(yaw, 0.0, 1e-4, 0.0);
    const double share = by_heading.heading_innovation(yaw, 0.0, 1e-4, 0.0).value_rad / innovation.value_rad;
    CHECK(share == Approx(1e-4 / innovation.variance_rad2).margin(0.03));
  }
}

TEST_CASE("the Jacobians of fixes and headings are the derivatives of their predictions") {
  Dice dice;
  constexpr double size = 1e-6;
  constexpr double ahead_s = 0.005;
  for (int i = 0; i < 20; ++i) {
    Filter filter = random_filter(dice);
    filter.angular_velocity_body_radps = dice.vector(1.0);
    const auto heading_of = [](const Filter& at) { return at.heading_innovation(0.0, 0.3, 1e-4, ahead_s); };
    const auto fix_of = [](const Filter& at) {
      return at.fix_innovation(Vector3d::Zero(), Matrix3d::Identity(), ahead_s).value_world_m;
    };
    for (int state = 0; state < state_size; ++state) {
      Filter above = filter;
      Filter below = filter;
      above.inject(size * StateVector::Unit(state));
      below.inject(-size * StateVector::Unit(state));
      // The innovation is minus the prediction. H omits the small turn until the stamp.
      const Vector3d by_state = (fix_of(below) - fix_of(above)) / (2.0 * size);
      CHECK((filter.fix_jacobian(ahead_s).col(state) - by_state).norm() < 0.02);
      if (!heading_of(filter).observable || state < at_attitude || state >= at_gyro_bias) continue;
      const double heading_by_state =
          geometry::wrap_angle(heading_of(below).value_rad - heading_of(above).value_rad) / (2.0 * size);
      CHECK(heading_of(filter).row(state - at_attitude) == Approx(heading_by_state).margin(0.02));
    }
  }
}

TEST_CASE("the delay moves fixes and headings as their derivatives demand") {
  Dice dice;
  constexpr double size_s = 1e-5;
  for (int i = 0; i < 20; ++i) {
    Filter filter = random_filter(dice);
    filter.angular_velocity_body_radps = dice.vector(1.0);
    filter.acceleration_world_mps2 = dice.vector(2.0);
    filter.covariance.setZero();
    filter.estimate_delay(1.0);
    const auto fix_after = [&](double delay_error_s) {
      filter.delay_error_s = delay_error_s;
      return filter.fix_innovation(Vector3d::Zero(), Matrix3d::Identity(), 0.005);
    };
    const auto heading_after = [&](double delay_error_s) {
      filter.delay_error_s = delay_error_s;
      return filter.heading_innovation(0.0, 0.3, 1e-4, 0.005);
    };
    // The innovation is minus the prediction.
    const Vector3d by_delay_mps =
        (fix_after(-size_s).value_world_m - fix_after(size_s).value_world_m) / (2.0 * size_s);
    CHECK((fix_after(0.0).delay_row - by_delay_mps).norm() < 1e-3);
    if (!heading_after(0.0).observable) continue;
    const double by_delay_radps =
        geometry::wrap_angle(heading_after(-size_s).value_rad - heading_after(size_s).value_rad) /
        (2.0 * size_s);
    CHECK(heading_after(0.0).delay_row == Approx(by_delay_radps).margin(1e-3));
  }
}

TEST_CASE("a time without samples may be crossed at once or in pieces") {
  Dice dice;
  const Filter start = random_filter(dice);
  Filter at_once = start;
  at_once.predict_without_imu(2.0, {});
  Filter in_pieces = start;
  for (int i = 0; i < 20; ++i) in_pieces.predict_without_imu(0.1, {});
  CHECK((at_once.position_world_m - in_pieces.position_world_m).norm() < 1e-12);
  CHECK((at_once.velocity_world_mps - in_pieces.velocity_world_mps).norm() < 1e-12);
  CHECK((at_once.covariance - in_pieces.covariance).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(at_once.covariance == at_once.covariance.transpose());
  // Without slowing, the velocity is a random walk.
  Filter shortly = start;
  shortly.predict_without_imu(0.01, {.velocity_time_constant_s = 1e6, .accel_mps2_rthz = 2.0});
  CHECK(shortly.covariance(at_velocity, at_velocity) - 1e-4 == Approx(0.01 * 4.0));
}

TEST_CASE("the covariance stays symmetric and positive over random steps", "[accuracy]") {
  Dice dice;
  Filter filter = random_filter(dice);
  filter.covariance = StateCovariance::Identity();
  filter.estimate_delay(1e-4);
  const unsigned steps = test::seeds(100'000, 1'000'000);
  const auto is_symmetric_and_positive = [&] {
    using Joint = Eigen::Matrix<double, state_size + 1, state_size + 1>;  // including the delay
    Joint joint;
    joint << filter.covariance, filter.delay_covariance, filter.delay_covariance.transpose(),
        filter.delay_variance_s2;
    return filter.covariance == filter.covariance.transpose() &&
           Eigen::LLT<Joint>(joint).info() == Eigen::Success;
  };
  for (unsigned i = 1; i <= steps; ++i) {
    filter.predict(dice.vector(3.0), Vector3d(0, 0, 9.8) + dice.vector(5.0), 0.01);
    if (i % 4 == 0) filter.propagate({});
    if (i % 8 == 0) {
      filter.correct_fix(filter.fix_innovation(filter.tracked_position_world_m() + dice.vector(0.05),
                                               dice.between(1e-6, 1e-2) * Matrix3d::Identity(),
                                               dice.between(0.0, 0.01)));
    }
    if (i % 12 == 0) {
      filter.correct_heading(geometry::yaw_of(filter.q_body_to_world) + dice.between(-0.1, 0.1), 0.3,
                             dice.between(1e-6, 1e-2), 0.0);
    }
    if (i % 1000 == 0) {
      filter.update_direct(at_gyro_bias, dice.vector(1e-3), 1e-8);
      filter.update_direct(at_velocity, dice.vector(1e-3), 1e-6);
    }
    if (i % 5000 == 0) {
      filter.propagate({});
      filter.predict_without_imu(0.3, {});
    }
    if (i % 20'000 == 0) {
      filter.turn_world(dice.between(-3.0, 3.0));
      filter.add_yaw_variance(dice.between(0.0, 0.1));
      filter.decorrelate(at_position, Vector3d::Constant(dice.between(1e-4, 1.0)));
    }
    if (i % 4 != 0) continue;
    REQUIRE(is_symmetric_and_positive());
    REQUIRE(filter.is_finite());
  }
}

}  // namespace kalman_filter_test
