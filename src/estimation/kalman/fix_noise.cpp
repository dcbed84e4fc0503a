#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <algorithm>

namespace sonopose::estimation::kalman {
namespace {

// A large guess that the first fixes overrule: with a small one the fixes that would correct it are rejected.
constexpr double initial_fix_variance_m2 = 0.05 * 0.05;
constexpr double most_fix_variance_m2 = 0.5 * 0.5;
constexpr double prior_fixes = 0.5;
constexpr double initial_heading_variance_rad2 = 0.026 * 0.026;  // 1.5°
constexpr double prior_headings = 8;
constexpr double fix_memory = 40;
constexpr double heading_memory = 60;

std::size_t bin_of(double quality_percent) {
  // Below 60 %, then steps of 10 %; sources without a quality share the first.
  const double bin =
      std::clamp((quality_percent - 50.0) / 10.0, 0.0, double{MeasurementNoise::bin_count - 1});
  return static_cast<std::size_t>(bin);
}

void add_moving_fix(AdaptiveVariance& known, const VarianceSample& sample) {
  constexpr double least_m2 = 0.01 * 0.01;
  known.add(sample, fix_memory, least_m2, most_fix_variance_m2);
}

/// The errors of a body at rest repeat, so small ones are no evidence: they only make the variance a little
/// harder to overrule for the first fixes of a drive.
void add_fix_at_rest(AdaptiveVariance& known, const VarianceSample& sample) {
  constexpr double rest_memory = 8;
  constexpr double enough = 4;
  if (std::max(known.variance, sample.variance) >= initial_fix_variance_m2) {
    const double least_m2 =
        known.samples > 0.0 ? std::min(known.variance, initial_fix_variance_m2) : initial_fix_variance_m2;
    known.add(sample, rest_memory, least_m2, most_fix_variance_m2);
  } else if (known.samples > 0.0 && known.samples < enough) {
    known.samples += sample.weight;
  }
}

}  // namespace

VarianceSample::VarianceSample(double squared_residual, double prediction_variance, double noise_variance)
    : variance(std::min(squared_residual + prediction_variance, 9.0 * noise_variance)) {
  const double left = std::max(0.0, 1.0 - prediction_variance / noise_variance);
  weight = left * left;
}

void AdaptiveVariance::add(const VarianceSample& sample, double memory, double least, double most) {
  constexpr double few = 8;
  constexpr double slow_growth = 0.25;  // beyond few: so that a wrong beginning is forgotten soon
  if (!(sample.weight > 0.0)) return;
  samples = std::min(samples + (samples < few ? 1.0 : slow_growth) * sample.weight, memory);
  variance = std::clamp(variance + (sample.variance - variance) * sample.weight / samples, least, most);
}

MeasurementNoise::MeasurementNoise() {
  any_quality.horizontal_m2 = {initial_fix_variance_m2, prior_fixes};
  any_quality.vertical_m2 = {initial_fix_variance_m2, prior_fixes};
  heading_rad2 = {initial_heading_variance_rad2, prior_headings};
}

Eigen::Matrix3d MeasurementNoise::fix_covariance_m2(double quality_percent) const {
  // The fewer fixes a range has seen, the more it is like the others.
  constexpr double common_fixes = 8;
  const auto mean = [](const AdaptiveVariance& own, const AdaptiveVariance& common) {
    return (own.samples * own.variance + common_fixes * common.variance) / (own.samples + common_fixes);
  };
  const Bin& bin = bins[bin_of(quality_percent)];
  const double horizontal_m2 = mean(bin.horizontal_m2, any_quality.horizontal_m2);
  return Vector3d(horizontal_m2, horizontal_m2, mean(bin.vertical_m2, any_quality.vertical_m2)).asDiagonal();
}

void MeasurementNoise::add_fix(double quality_percent, const Vector3d& residual_m,
                               const Vector3d& prediction_variance_m2, bool at_rest) {
  const Vector3d variance_m2 = fix_covariance_m2(quality_percent).diagonal();
  const Vector3d squares_m2 = residual_m.cwiseAbs2();
  const VarianceSample horizontal(squares_m2.head<2>().mean(), prediction_variance_m2.head<2>().mean(),
                                  variance_m2.x());
  const VarianceSample vertical(squares_m2.z(), prediction_variance_m2.z(), variance_m2.z());
  const auto add = at_rest ? add_fix_at_rest : add_moving_fix;
  for (Bin* bin : {&any_quality, &bins[bin_of(quality_percent)]}) {
    add(bin->horizontal_m2, horizontal);
    add(bin->vertical_m2, vertical);
  }
}

void MeasurementNoise::add_heading(double residual_rad, double prediction_variance_rad2) {
  constexpr double least_rad2 = 0.003 * 0.003;
  constexpr double most_rad2 = 0.35 * 0.35;
  heading_rad2.add({residual_rad * residual_rad, prediction_variance_rad2, heading_rad2.variance},
                   heading_memory, least_rad2, most_rad2);
}

}  // namespace sonopose::estimation::kalman
