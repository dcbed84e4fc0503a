#include <sonopose/estimation/kalman/fix_noise.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

// The initial guess is large, and the first fixes overrule it. With a small one, the fixes that would correct
// it are rejected.
constexpr VarianceLimits fix_limits_m2{
    .initial = 0.05 * 0.05, .min = 0.01 * 0.01, .max = 0.5 * 0.5, .memory_samples = 40};
constexpr double prior_fixes = 0.5;
constexpr double prior_vertical_fixes = 0.05;
constexpr double initial_vertical_m2 =
    0.12 * 0.12;  // if all beacons are equally high, the height is uncertain
// Standard deviations of 2.3°, 0.17° and 20°.
constexpr VarianceLimits heading_limits_rad2{
    .initial = 0.04 * 0.04, .min = 0.003 * 0.003, .max = 0.35 * 0.35, .memory_samples = 60};
constexpr double prior_headings = 3;

std::size_t bin_of(double quality_percent) {
  // Below 60 %, then steps of 10 %; sources without a quality share the first.
  const double bin =
      std::clamp((quality_percent - 50.0) / 10.0, 0.0, double{MeasurementNoise::bin_count - 1});
  return static_cast<std::size_t>(bin);
}

constexpr double initial_samples = 8;

void move_towards(double& variance, const VarianceSample& sample, double samples,
                  const VarianceLimits& limits) {
  variance += (sample.variance - variance) * sample.weight / samples;
  variance = std::clamp(variance, limits.min, limits.max);
}

/// Horizontal and vertical share of a residual.
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
  const double residual_share = std::max(0.0, 1.0 - prediction_variance / noise_variance);
  weight = residual_share * residual_share;
}

void AdaptiveVariance::count(const VarianceSample& sample, double max_samples) {
  constexpr double slow_growth = 0.2;  // beyond a few, so that a wrong beginning is soon forgotten
  const double growth = samples < initial_samples ? 1.0 : slow_growth;
  samples = std::min(samples + growth * sample.weight, max_samples);
}

void AdaptiveVariance::add_rejected(const VarianceSample& sample, const VarianceLimits& limits) {
  samples = std::clamp(samples, 1.0, initial_samples);
  move_towards(variance, sample, samples, limits);
}

void AdaptiveVariance::add(const VarianceSample& sample, const VarianceLimits& limits, double first) {
  if (!(sample.weight > 0.0)) return;
  if (motion_variance == 0.0) motion_variance = first;
  count(sample, limits.memory_samples);
  move_towards(variance, sample, samples, limits);
  // The first residuals are mostly errors of the first fix.
  const bool is_of_noise = sample.weight > 0.9 || variance <= limits.initial || samples >= initial_samples;
  if (is_of_noise) move_towards(motion_variance, sample, samples, limits);
}

void AdaptiveVariance::add_at_rest(const VarianceSample& sample, const VarianceLimits& limits,
                                   double min_variance) {
  constexpr double large_ratio = 8.0;   // so that usual samples do not raise it by chance
  constexpr double rest_samples = 4.5;  // with fewer, a wrong mount would count as noise on the first drive
  if (!(sample.weight > 0.0)) return;
  const double before = samples;
  if (variance > min_variance || sample.variance >= std::min(limits.initial, large_ratio * variance)) {
    count(sample, std::max(before, initial_samples));
    move_towards(variance, sample, samples, limits);
  }
  if (variance > min_variance) return;
  variance = min_variance;
  samples = std::max(before, std::min(before + sample.weight, rest_samples));
}

void Correlation::add(const Vector3d& value_m, const Eigen::Matrix3d& covariance_m2) {
  constexpr double smoothing_factor = 1.0 / 20.0;
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance_m2);
  const Vector3d normalised = factor.matrixL().solve(value_m);
  product += smoothing_factor * (normalised.dot(last) / 3.0 - product);
  square += smoothing_factor * (normalised.squaredNorm() / 3.0 - square);
  last = normalised;
}

double Correlation::white_share() const {
  constexpr double by_chance = 0.6;  // among twenty pairs
  const double correlated = std::max(0.0, product - by_chance);
  return std::clamp(1.0 - correlated / std::max(square, 0.1), 0.1, 1.0);
}

void FixScatter::add(TimeNs time_ns, const Vector3d& position_m) {
  constexpr double max_interval_s = 1.0;  // further apart the motion is unknown
  constexpr double acceleration_mps2 = 10.0;
  if (time_ns <= last_ns) return;
  const double dt_s = seconds_between(last_ns, time_ns);
  const double before_s = seconds_between(before_ns, last_ns);
  if (before_ns != 0) add_steps(position_m);
  if (before_ns != 0 && dt_s < max_interval_s && before_s < max_interval_s) {
    const double ratio = dt_s / before_s;
    const Vector3d error_m = position_m - last_m - ratio * (last_m - before_m);
    add_error(error_m.cwiseAbs2() / (1.0 + (1.0 + ratio) * (1.0 + ratio) + ratio * ratio));
    const double by_motion_m = acceleration_mps2 * dt_s * before_s;
    motion_m2 += (by_motion_m * by_motion_m / 6.0 - motion_m2) / samples;
  }
  before_m = last_m;
  before_ns = last_ns;
  last_m = position_m;
  last_ns = time_ns;
}

void FixScatter::add_steps(const Vector3d& position_m) {
  constexpr double max_m = 0.25;
  constexpr double resolution_decay = 0.9;
  constexpr double max_repeats = 40;  // a coordinate may be constant, as in a map without heights
  for (int i = 0; i < 3; ++i) {
    const double step_m = std::abs(position_m[i] - last_m[i]);
    if (step_m == 0.0) {
      repeats[i] = std::min(repeats[i] + 1.0, max_repeats);
      continue;
    }
    const bool has_repeated = repeats[i] > 0.0;
    repeats[i] = 0.0;
    resolution_m[i] = has_repeated && step_m <= max_m ? step_m : resolution_decay * resolution_m[i];
  }
}

void FixScatter::add_error(const Vector3d& sample_m2) {
  constexpr double median = 0.455;  // median of the square of a normal variable
  constexpr double step = 1.1;
  samples = std::min(samples + 1, max_samples);
  for (int i = 0; i < 3; ++i) {
    if (sample_m2[i] == 0.0) continue;  // a coarse coordinate repeats
    if (samples < max_samples) {
      variance_m2[i] += (sample_m2[i] - variance_m2[i]) / samples;
    } else {
      variance_m2[i] *= sample_m2[i] > median * variance_m2[i] ? step : 1.0 / step;
    }
  }
}

Vector3d FixScatter::mean_m2() const {
  const double horizontal_m2 = 0.5 * (variance_m2.x() + variance_m2.y());
  return {horizontal_m2, horizontal_m2, variance_m2.z()};
}

Vector3d FixScatter::max_m2() const {
  constexpr double max_ratio = 4.0;
  if (samples < min_samples) return Vector3d::Constant(fix_limits_m2.max);
  return (max_ratio * mean_m2()).cwiseMax(fix_limits_m2.initial);
}

Vector3d FixScatter::rounding_m2() const {
  // A coordinate that repeats has the same error again, and may not have shown its own step yet.
  constexpr double growth_per_repeat = 0.3;
  const Vector3d step_m =
      (repeats.array() > 0.0).select(Vector3d::Constant(resolution_m.maxCoeff()), resolution_m);
  return (step_m.array().square() / 12.0 * (1.0 + growth_per_repeat * repeats.array()))
      .cwiseMin(fix_limits_m2.max);
}

Vector3d FixScatter::noise_m2() const {
  constexpr double certain_share = 0.5;
  if (samples < min_samples) return Vector3d::Zero();
  return (certain_share * (mean_m2().array() - motion_m2)).cwiseMax(0.0).cwiseMin(fix_limits_m2.max);
}

MeasurementNoise::MeasurementNoise() {
  constexpr AdaptiveVariance horizontal_m2{fix_limits_m2.initial, prior_fixes, fix_limits_m2.initial};
  constexpr AdaptiveVariance vertical_m2{initial_vertical_m2, prior_vertical_fixes, fix_limits_m2.initial};
  any_quality = {horizontal_m2, vertical_m2};
  heading_rad2 = {heading_limits_rad2.initial, prior_headings, heading_limits_rad2.initial};
}

void MeasurementNoise::start_from(double fix_std_m) {
  any_quality.horizontal_m2.variance =
      std::clamp(fix_std_m * fix_std_m, fix_limits_m2.min, fix_limits_m2.max);
}

Eigen::Matrix3d MeasurementNoise::fix_covariance_m2(double quality_percent) const {
  // The fewer fixes a range has seen, the more it resembles the others.
  constexpr double common_fixes = 8;
  const auto mean = [](const AdaptiveVariance& own, const AdaptiveVariance& common) {
    return (own.samples * own.variance + common_fixes * common.variance) / (own.samples + common_fixes);
  };
  const Bin& bin = bins[bin_of(quality_percent)];
  const double horizontal_m2 = mean(bin.horizontal_m2, any_quality.horizontal_m2);
  return Vector3d(horizontal_m2, horizontal_m2, mean(bin.vertical_m2, any_quality.vertical_m2))
      .cwiseMin(scatter.max_m2())
      .cwiseMax(scatter.rounding_m2())
      .asDiagonal();
}

void MeasurementNoise::add_fix(double quality_percent, const Vector3d& residual_m,
                               const Vector3d& prediction_variance_m2, bool at_rest) {
  const FixSamples of(residual_m, prediction_variance_m2, fix_covariance_m2(quality_percent).diagonal());
  const auto add = [&](AdaptiveVariance& known, const AdaptiveVariance& common,
                       const VarianceSample& sample) {
    if (at_rest) {
      const double min_m2 = known.motion_variance > 0.0 ? known.motion_variance : common.motion_variance;
      known.add_at_rest(sample, fix_limits_m2, min_m2);
    } else {
      known.add(sample, fix_limits_m2, common.motion_variance);
    }
  };
  for (Bin* bin : {&any_quality, &bins[bin_of(quality_percent)]}) {
    add(bin->horizontal_m2, any_quality.horizontal_m2, of.horizontal);
    add(bin->vertical_m2, any_quality.vertical_m2, of.vertical);
  }
}

void MeasurementNoise::add_rejected_fix(double quality_percent, const Vector3d& innovation_m) {
  const FixSamples of(innovation_m, Vector3d::Zero(), fix_covariance_m2(quality_percent).diagonal());
  for (Bin* bin : {&any_quality, &bins[bin_of(quality_percent)]}) {
    bin->horizontal_m2.add_rejected(of.horizontal, fix_limits_m2);
    bin->vertical_m2.add_rejected(of.vertical, fix_limits_m2);
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
