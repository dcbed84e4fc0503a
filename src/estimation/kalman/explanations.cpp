#include "estimation/kalman/belief_parts.hpp"
#include <sonopose/estimation/kalman/explanations.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {

void Correlation::add(const Innovation& innovation) {
  constexpr double share = 1.0 / 20.0;
  const Eigen::LLT<Matrix3d> factor(innovation.covariance_m2);
  const Vector3d normalised = factor.matrixL().solve(innovation.value_world_m);
  product += share * (normalised.dot(last) / 3.0 - product);
  square += share * (normalised.squaredNorm() / 3.0 - square);
  last = normalised;
}

double Correlation::white_share() const {
  constexpr double by_chance = 0.6;  // of twenty pairs
  const double correlated = std::max(0.0, product - by_chance);
  return std::clamp(1.0 - correlated / std::max(square, 0.1), 0.1, 1.0);
}

namespace {

/// An innovation of this value and covariance.
Innovation between(const Vector3d& value_m, const Matrix3d& covariance_m2) {
  Innovation innovation;
  const Eigen::LLT<Matrix3d> factor(covariance_m2);
  innovation.squared_norm = factor.matrixL().solve(value_m).squaredNorm();
  innovation.log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return innovation;
}

}  // namespace

/// Fixes that scatter about the best filter only have more noise.
double Explanations::of_noise(const Innovation& of_best_innovation) {
  constexpr double share = 1.0 / 6.0;
  const Vector3d squares_m2 = of_best_innovation.value_world_m.cwiseAbs2();
  const bool is_known = scatter_m2.x() > 0.0;
  const Matrix3d covariance = scatter_m2.cwiseMax(of_best_innovation.covariance_m2.diagonal()).asDiagonal();
  scatter_m2 += (is_known ? share : 1.0) * (squares_m2 - scatter_m2);
  return is_known ? log_likelihood_or_wrong(between(of_best_innovation.value_world_m, covariance))
                  : wrong_fix;
}

/// Fixes whose offset from the best filter stays or grows evenly form another track. A wrong IMU leads the
/// filter away faster and faster.
double Explanations::of_shift(TimeNs time_ns, const Vector3d& offset, const Matrix3d& covariance) {
  constexpr double other_above = 16.0;
  constexpr double drift_std_mps = 0.2;
  constexpr double drift_change_mps_rts = 0.05;
  const double noise_m2 = covariance.diagonal().maxCoeff();
  const double dt_s = seconds_between(shift_ns, time_ns);
  shift_ns = time_ns;
  const double rate_variance = shift_rate_variance + square(drift_change_mps_rts) * dt_s;
  const double both = shift_covariance + dt_s * shift_rate_variance;
  const double variance = shift_variance_m2 + dt_s * (shift_covariance + both);
  const Vector3d predicted_m = shift_world_m + dt_s * shift_world_mps;
  const Innovation innovation = between(offset - predicted_m, covariance + variance * Matrix3d::Identity());
  if (shift_variance_m2 == 0.0 || innovation.squared_norm > other_above) {
    shift_world_m = offset;
    shift_world_mps.setZero();
    shift_variance_m2 = noise_m2;
    shift_covariance = 0.0;
    shift_rate_variance = square(drift_std_mps);
    return wrong_fix;
  }
  const double gain = variance / (variance + noise_m2);
  const double rate_gain = both / (variance + noise_m2);
  shift_world_m = predicted_m + gain * (offset - predicted_m);
  shift_world_mps += rate_gain * (offset - predicted_m);
  shift_variance_m2 = (1.0 - gain) * variance;
  shift_covariance = (1.0 - gain) * both;
  shift_rate_variance = rate_variance - rate_gain * both;
  return log_likelihood_or_wrong(innovation);
}

/// The best filter may reject a heading because iron turned it, by a limited angle. An angle beyond that
/// shows that the gyro is wrong.
void Explanations::add_heading(const Filter::HeadingInnovation& of_best,
                               const Filter::HeadingInnovation& of_gyro) {
  constexpr double turned_std_rad = radians(20.0);
  constexpr double wrong = -4.8;  // anywhere
  const auto likelihood = [&](const Filter::HeadingInnovation& innovation) {
    return std::max(kalman::log_likelihood(innovation), wrong);
  };
  const double turned = 3.0 - 0.5 * square(of_best.value_rad / turned_std_rad);
  const double added = std::max(likelihood(of_best), turned);
  best += added;
  rival += added;
  accel += added;
  if (of_gyro.observable) gyro += likelihood(of_gyro);
}

}  // namespace sonopose::estimation::kalman
