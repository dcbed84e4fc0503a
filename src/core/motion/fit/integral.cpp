#include "motion/fit/integral.hpp"

#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::motion::fit::detail {
namespace {

/// Rotations in a step of constant rate.
struct Turn {
  Turn(const IntegralState& state, const Vector3d& rate_radps, double dt_s)
      : half(geometry::rotation_by((0.5 * dt_s * rate_radps).eval())),
        middle_to_start((state.q_body_to_start * half).toRotationMatrix()) {}

  Eigen::Quaterniond half;
  Eigen::Matrix3d middle_to_start;  ///< from the body in the middle of the step
};

/// Moves the derivatives by a step of constant rate and force.
void advance_derivatives(IntegralState& state, const Turn& turn, const Vector3d& force_mps2, double dt_s) {
  const Eigen::Matrix3d half_back = turn.half.toRotationMatrix().transpose();
  const Eigen::Matrix3d middle_by_gyro =
      half_back * state.attitude_by_gyro - 0.5 * dt_s * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d force_by_gyro =
      -turn.middle_to_start * geometry::cross_matrix(force_mps2) * middle_by_gyro;
  const double half_square = 0.5 * dt_s * dt_s;
  state.position_by_gyro += dt_s * state.velocity_by_gyro + half_square * force_by_gyro;
  state.position_by_accel += dt_s * state.velocity_by_accel - half_square * turn.middle_to_start;
  state.velocity_by_gyro += dt_s * force_by_gyro;
  state.velocity_by_accel -= dt_s * turn.middle_to_start;
  state.attitude_by_gyro = half_back * middle_by_gyro - 0.5 * dt_s * Eigen::Matrix3d::Identity();
}

/// Moves the rest of the state by such a step.
void advance(IntegralState& state, const Turn& turn, const Vector3d& force_mps2, double dt_s) {
  const Vector3d force = turn.middle_to_start * force_mps2;
  state.position_m += dt_s * state.velocity_mps + 0.5 * dt_s * dt_s * force;
  state.velocity_mps += dt_s * force;
  state.q_body_to_start = (state.q_body_to_start * turn.half * turn.half).normalized();
  state.since_start_s += dt_s;
}

}  // namespace

Integral::Integral(std::span<const Reading> imu, Vector3d signs) : imu_(imu), signs_(std::move(signs)) {
  states_.reserve(imu.size());
  integrate();
}

void Integral::set_biases(const Vector3d& gyro_bias_radps, const Vector3d& accel_bias_mps2) {
  // What is not linear then moves the position by less than 1 cm in 8 s, less than the noise of a fix.
  constexpr double max_gyro_change_radps = 5e-4;
  constexpr double max_accel_change_mps2 = 0.2;
  gyro_bias_change_radps_ = gyro_bias_radps - gyro_bias_radps_;
  accel_bias_change_mps2_ = accel_bias_mps2 - accel_bias_mps2_;
  if (gyro_bias_change_radps_.norm() <= max_gyro_change_radps &&
      accel_bias_change_mps2_.norm() <= max_accel_change_mps2)
    return;
  gyro_bias_radps_ = gyro_bias_radps;
  accel_bias_mps2_ = accel_bias_mps2;
  gyro_bias_change_radps_.setZero();
  accel_bias_change_mps2_.setZero();
  integrate();
}

void Integral::integrate() {
  states_.clear();
  for (const Reading& reading : imu_) {
    IntegralState state = states_.empty() ? IntegralState{} : states_.back();
    const Vector3d rate = reading.rate_body_radps - gyro_bias_radps_;
    const Vector3d force = signs_.cwiseProduct(reading.force_body_mps2) - accel_bias_mps2_;
    if (!states_.empty()) {
      const double dt_s = seconds_between(imu_.front().time_ns, reading.time_ns) - state.since_start_s;
      const Turn turn(state, 0.5 * (rate + state.rate_body_radps), dt_s);
      const Vector3d mean_force = 0.5 * (force + state.force_body_mps2);
      advance_derivatives(state, turn, mean_force, dt_s);
      advance(state, turn, mean_force, dt_s);
    }
    state.rate_body_radps = rate;
    state.force_body_mps2 = force;
    states_.push_back(state);
  }
}

IntegralState Integral::at(double since_start_s) const {
  const auto after = std::upper_bound(
      states_.begin(), states_.end(), since_start_s,
      [](double time_s, const IntegralState& state) { return time_s < state.since_start_s; });
  IntegralState state = after == states_.begin() ? states_.front() : *std::prev(after);
  const double dt_s = since_start_s - state.since_start_s;
  const Vector3d& gyro = gyro_bias_change_radps_;
  const Vector3d& accel = accel_bias_change_mps2_;
  state.q_body_to_start *= geometry::rotation_by((state.attitude_by_gyro * gyro).eval());
  state.velocity_mps += state.velocity_by_gyro * gyro + state.velocity_by_accel * accel;
  state.position_m += state.position_by_gyro * gyro + state.position_by_accel * accel;
  state.rate_body_radps -= gyro;
  state.force_body_mps2 -= accel;
  state.position_by_gyro += dt_s * state.velocity_by_gyro;
  state.position_by_accel += dt_s * state.velocity_by_accel;
  state.attitude_by_gyro.diagonal().array() -= dt_s;
  advance(state, Turn(state, state.rate_body_radps, dt_s), state.force_body_mps2, dt_s);
  return state;
}

}  // namespace sonopose::motion::fit::detail
