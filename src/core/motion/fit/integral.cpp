#include "motion/fit/integral.hpp"

#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>

namespace sonopose::motion::fit::detail {
namespace {

/// Moves the state by a step of constant rate and force.
void advance(IntegralState& state, const Vector3d& rate_radps, const Vector3d& force_mps2, double dt_s) {
  const Eigen::Quaterniond half = geometry::rotation_by((0.5 * dt_s * rate_radps).eval());
  const Eigen::Matrix3d to_start = (state.q_body_to_start * half).toRotationMatrix();
  const Eigen::Matrix3d half_back = half.toRotationMatrix().transpose();
  const Eigen::Matrix3d middle_by_gyro =
      half_back * state.attitude_by_gyro - 0.5 * dt_s * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d force_by_gyro = -to_start * geometry::cross_matrix(force_mps2) * middle_by_gyro;
  const Vector3d force = to_start * force_mps2;
  const double half_square = 0.5 * dt_s * dt_s;
  state.position_m += dt_s * state.velocity_mps + half_square * force;
  state.position_by_gyro += dt_s * state.velocity_by_gyro + half_square * force_by_gyro;
  state.position_by_accel += dt_s * state.velocity_by_accel - half_square * to_start;
  state.velocity_mps += dt_s * force;
  state.velocity_by_gyro += dt_s * force_by_gyro;
  state.velocity_by_accel -= dt_s * to_start;
  state.attitude_by_gyro = half_back * middle_by_gyro - 0.5 * dt_s * Eigen::Matrix3d::Identity();
  state.q_body_to_start = (state.q_body_to_start * half * half).normalized();
  state.since_start_s += dt_s;
}

}  // namespace

std::vector<IntegralState> integral_of(std::span<const Reading> imu, const Vector3d& signs,
                                       const Vector3d& gyro_bias_radps, const Vector3d& accel_bias_mps2) {
  std::vector<IntegralState> states;
  states.reserve(imu.size());
  for (const Reading& reading : imu) {
    IntegralState state = states.empty() ? IntegralState{} : states.back();
    const Vector3d rate = reading.rate_body_radps - gyro_bias_radps;
    const Vector3d force = signs.cwiseProduct(reading.force_body_mps2) - accel_bias_mps2;
    if (!states.empty()) {
      const double dt_s = seconds_between(imu.front().time_ns, reading.time_ns) - state.since_start_s;
      advance(state, 0.5 * (rate + state.rate_body_radps), 0.5 * (force + state.force_body_mps2), dt_s);
    }
    state.rate_body_radps = rate;
    state.force_body_mps2 = force;
    states.push_back(state);
  }
  return states;
}

IntegralState state_at(const std::vector<IntegralState>& states, double since_start_s) {
  const auto after = std::upper_bound(
      states.begin(), states.end(), since_start_s,
      [](double time_s, const IntegralState& state) { return time_s < state.since_start_s; });
  IntegralState state = after == states.begin() ? states.front() : *std::prev(after);
  const double dt_s = since_start_s - state.since_start_s;
  advance(state, state.rate_body_radps, state.force_body_mps2, dt_s);
  return state;
}

}  // namespace sonopose::motion::fit::detail
