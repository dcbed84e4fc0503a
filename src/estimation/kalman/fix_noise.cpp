#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

// The initial guess is large, and the first fixes overrule it: with a small one the fixes that would correct
// it are rejected.
constexpr VarianceLimits fix_limits_m2{
    .initial = 0.05 * 0.05, .least = 0.01 * 0.01, .most = 0.5 * 0.5, .memory_samples = 40};
constexpr double prior_fixes = 0.5;
constexpr double prior_vertical_fixes = 0.05;
constexpr double initial_vertical_m2 = 0.12 * 0.12;  // where all beacons are as high, the height is uncertain
// Standard deviations of 1.5°, 0.17° and 20°.
constexpr VarianceLimits heading_limits_rad2{
    .initial = 0.026 * 0.026, .least = 0.003 * 0.003, .most = 0.35 * 0.35, .memory_samples = 60};
constexpr double prior_headings = 8;

std::size_t bin_of(double quality_percent) {
  // Below 60 %, then steps of 10 %; sources without a quality share the first.
  const double bin =
      std::clamp((quality_percent - 50.0) / 10.0, 0.0, double{MeasurementNoise::bin_count - 1});
  return static_cast<std::size_t>(bin);
}

constexpr double few_samples = 8;

void move_towards(double& variance, const VarianceSample& sample, double samples,
                  const VarianceLimits& limits) {
  variance += (sample.variance - variance) * sample.weight / samples;
  variance = std::clamp(variance, limits.least, limits.most);
}

/// The horizontal and the vertical share of a residual.
struct FixSamples {
  VarianceSample horizontal;
  VarianceSample vertical;

  FixSamples(const Vector3d& residual_m, const Vector3d& prediction_variance_m2,
             const Vector3d& noise_variance_m2)
      : horizontal(residual_m.cwiseAbs2().head<2>().mean(), prediction_variance_m2.head<2>().mean(),
                   noise_variance_m2.x()),
        vertical(residual_m.z() * residual_m.z(), prediction_variance_m2.z(), noise_variance_m2.z()) {}
};

}  // namespace

VarianceSample::VarianceSample(double squared_residual, double prediction_variance, double noise_variance)
    : variance(std::min(squared_residual + prediction_variance, 9.0 * noise_variance)) {
  const double left = std::max(0.0, 1.0 - prediction_variance / noise_variance);
  weight = left * left;
}

void AdaptiveVariance::count(const VarianceSample& sample, double most_samples) {
  constexpr double slow_growth = 0.2;  // beyond a few: so that a wrong beginning is forgotten soon
  const double growth = samples < few_samples ? 1.0 : slow_growth;
  samples = std::min(samples + growth * sample.weight, most_samples);
}

void AdaptiveVariance::add_doubtful(const VarianceSample& sample, const VarianceLimits& limits) {
  samples = std::clamp(samples, 1.0, few_samples);
  move_towards(variance, sample, samples, limits);
}

void AdaptiveVariance::add(const VarianceSample& sample, const VarianceLimits& limits, double first) {
  if (!(sample.weight > 0.0)) return;
  if (motion_variance == 0.0) motion_variance = first;
  count(sample, limits.memory_samples);
  move_towards(variance, sample, samples, limits);
  // The first residuals are mostly errors of the first fix.
  const bool is_of_noise = sample.weight > 0.9 || variance <= limits.initial || samples >= few_samples;
  if (is_of_noise) move_towards(motion_variance, sample, samples, limits);
}

void AdaptiveVariance::add_at_rest(const VarianceSample& sample, const VarianceLimits& limits, double least) {
  constexpr double large_ratio = 8.0;   // so that usual samples do not raise it by chance
  constexpr double rest_samples = 4.5;  // with fewer, a wrong mount would count as noise on the first way
  if (!(sample.weight > 0.0)) return;
  const double before = samples;
  if (variance > least || sample.variance >= std::min(limits.initial, large_ratio * variance)) {
    count(sample, std::max(before, few_samples));
    move_towards(variance, sample, samples, limits);
  }
  if (variance > least) return;
  variance = least;
  samples = std::max(before, std::min(before + sample.weight, rest_samples));
}

void Correlation::add(const Vector3d& value_m, const Eigen::Matrix3d& covariance_m2) {
  constexpr double share = 1.0 / 20.0;
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance_m2);
  const Vector3d normalised = factor.matrixL().solve(value_m);
  product += share * (normalised.dot(last) / 3.0 - product);
  square += share * (normalised.squaredNorm() / 3.0 - square);
  last = normalised;
}

double Correlation::white_share() const {
  constexpr double by_chance = 0.6;  // of twenty pairs
  const double correlated = std::max(0.0, product - by_chance);
  return std::clamp(1.0 - correlated / std::max(square, 0.1), 0.1, 1.0);
}

MeasurementNoise::MeasurementNoise() {
  constexpr AdaptiveVariance horizontal_m2{fix_limits_m2.initial, prior_fixes, fix_limits_m2.initial};
  constexpr AdaptiveVariance vertical_m2{initial_vertical_m2, prior_vertical_fixes, fix_limits_m2.initial};
  any_quality = {horizontal_m2, vertical_m2};
  heading_rad2 = {heading_limits_rad2.initial, prior_headings, heading_limits_rad2.initial};
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
  const FixSamples of(residual_m, prediction_variance_m2, fix_covariance_m2(quality_percent).diagonal());
  const auto add = [&](AdaptiveVariance& known, const AdaptiveVariance& common,
                       const VarianceSample& sample) {
    if (at_rest) {
      const double least_m2 = known.motion_variance > 0.0 ? known.motion_variance : common.motion_variance;
      known.add_at_rest(sample, fix_limits_m2, least_m2);
    } else {
      known.add(sample, fix_limits_m2, common.motion_variance);
    }
  };
  for (Bin* bin : {&any_quality, &bins[bin_of(quality_percent)]}) {
    add(bin->horizontal_m2, any_quality.horizontal_m2, of.horizontal);
    add(bin->vertical_m2, any_quality.vertical_m2, of.vertical);
  }
}

void MeasurementNoise::add_scattered_fix(double quality_percent, const Vector3d& innovation_m) {
  const FixSamples of(innovation_m, Vector3d::Zero(), fix_covariance_m2(quality_percent).diagonal());
  for (Bin* bin : {&any_quality, &bins[bin_of(quality_percent)]}) {
    bin->horizontal_m2.add_doubtful(of.horizontal, fix_limits_m2);
    bin->vertical_m2.add_doubtful(of.vertical, fix_limits_m2);
  }
}

void MeasurementNoise::add_heading(double residual_rad, double prediction_variance_rad2, bool at_rest) {
  const VarianceSample sample(residual_rad * residual_rad, prediction_variance_rad2, heading_rad2.variance);
  if (at_rest) {
    heading_rad2.add_at_rest(sample, heading_limits_rad2, heading_rad2.motion_variance);
  } else {
    heading_rad2.add(sample, heading_limits_rad2, heading_rad2.motion_variance);
  }
}

}  // namespace sonopose::estimation::kalman
