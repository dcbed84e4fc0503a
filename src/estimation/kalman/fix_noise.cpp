#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <algorithm>

namespace sonopose::estimation::kalman {
namespace {

constexpr double initial_fix_variance_m2 = 0.02 * 0.02;
constexpr double initial_heading_variance_rad2 = 0.026 * 0.026;  // 1.5°
constexpr double prior_samples = 8;
constexpr double fix_memory = 40;
constexpr double heading_memory = 60;

std::size_t bin_of(double quality_percent) {
  // Below 60 %, then steps of 10 %; sources without a quality share the first.
  const double bin =
      std::clamp((quality_percent - 50.0) / 10.0, 0.0, double{MeasurementNoise::bin_count - 1});
  return static_cast<std::size_t>(bin);
}

}  // namespace

void AdaptiveVariance::add(double sample, double memory, double least, double most) {
  samples = std::min(samples + 1.0, memory);
  const double clipped = std::min(sample, 9.0 * variance);
  variance = std::clamp(variance + (clipped - variance) / samples, least, most);
}

MeasurementNoise::MeasurementNoise() {
  for (Bin& bin : bins) {
    bin.horizontal_m2 = {initial_fix_variance_m2, prior_samples};
    bin.vertical_m2 = {initial_fix_variance_m2, prior_samples};
  }
  heading_rad2 = {initial_heading_variance_rad2, prior_samples};
}

Eigen::Matrix3d MeasurementNoise::fix_covariance_m2(double quality_percent) const {
  const Bin& bin = bins[bin_of(quality_percent)];
  return Vector3d(bin.horizontal_m2.variance, bin.horizontal_m2.variance, bin.vertical_m2.variance)
      .asDiagonal();
}

void MeasurementNoise::add_fix(double quality_percent, const Vector3d& residual_m,
                               const Vector3d& prediction_variance_m2) {
  constexpr double least_m2 = 0.01 * 0.01;
  constexpr double most_m2 = 0.5 * 0.5;
  Bin& bin = bins[bin_of(quality_percent)];
  const Vector3d sample = residual_m.cwiseAbs2() + prediction_variance_m2;
  bin.horizontal_m2.add(0.5 * (sample.x() + sample.y()), fix_memory, least_m2, most_m2);
  bin.vertical_m2.add(sample.z(), fix_memory, least_m2, most_m2);
}

void MeasurementNoise::add_heading(double residual_rad, double prediction_variance_rad2) {
  constexpr double least_rad2 = 0.003 * 0.003;
  constexpr double most_rad2 = 0.35 * 0.35;
  heading_rad2.add(residual_rad * residual_rad + prediction_variance_rad2, heading_memory, least_rad2,
                   most_rad2);
}

}  // namespace sonopose::estimation::kalman
