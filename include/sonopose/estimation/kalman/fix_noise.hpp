#pragma once
/// \file
/// The measurement noise of fixes and headings, learned from their residuals.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

#include <Eigen/Core>

#include <array>

namespace sonopose::estimation::kalman {

/// A squared residual as a sample of the noise.
struct VarianceSample {
  double variance = 0;
  /// Square of 1 − K, with the gain K of the correction: the residual keeps 1 − K of the noise.
  double weight = 0;

  /// `prediction_variance` is the variance after the correction. A stray residual counts as one of three
  /// deviations.
  VarianceSample(double squared_residual, double prediction_variance, double noise_variance);
};

/// Limits and memory of a learned variance.
struct VarianceLimits {
  double initial = 0;
  double min = 0;
  double max = 0;
  double memory_samples = 0;
};

/// A running variance that starts with a prior guess and forgets.
struct AdaptiveVariance {
  double variance = 0;
  double samples = 0;          ///< number of samples behind it, up to the memory
  double motion_variance = 0;  ///< variance without the samples of a body at rest; 0: unknown

  /// Adds a sample. `first` is the motion variance before the first one.
  void add(const VarianceSample& sample, const VarianceLimits& limits, double first);
  /// Adds a sample of a body at rest. Its errors repeat: they may show that the noise is large, but not that
  /// it is small. The variance therefore does not fall below `min_variance`. Once a large sample has raised
  /// it, others count as well.
  void add_at_rest(const VarianceSample& sample, const VarianceLimits& limits, double min_variance);
  /// Adds a sample of a rejected fix; the samples so far then count as a few. The motion variance stays, and
  /// at rest the variance returns to it.
  void add_rejected(const VarianceSample& sample, const VarianceLimits& limits);
  bool operator==(const AdaptiveVariance&) const = default;

private:
  void count(const VarianceSample& sample, double max_samples);
};

/// Correlation of consecutive innovations. It is zero if the gain is right; motion errors of any size make it
/// positive (Mehra, On the Identification of Variances and Adaptive Kalman Filtering, 1970).
struct Correlation {
  Vector3d last = Vector3d::Zero();  ///< normalised innovation
  double product = 0;                ///< mean of the products
  double square = 1;                 ///< mean of the squares

  void add(const Vector3d& value_m, const Eigen::Matrix3d& covariance_m2);
  /// Share of the mean square that is white noise.
  [[nodiscard]] double white_share() const;
  bool operator==(const Correlation&) const = default;
};

/// Noise of the fixes, independent of the IMU: the distance of each from the line through the two before. It
/// includes what motion adds, so it is an upper bound.
struct FixScatter {
  static constexpr int min_samples = 6;  ///< fewest meaningful samples
  static constexpr int max_samples =
      16;  ///< number of samples that are averaged before a running median begins

  Vector3d last_m = Vector3d::Zero();
  Vector3d before_m = Vector3d::Zero();
  TimeNs last_ns = 0;
  TimeNs before_ns = 0;  ///< 0 with fewer than two fixes
  int samples = 0;
  Vector3d variance_m2 = Vector3d::Zero();   ///< variance of a fix, assuming no acceleration
  double motion_m2 = 0;                      ///< share of it that the motion may have
  Vector3d resolution_m = Vector3d::Zero();  ///< step of coordinates that repeat; 0: none
  Vector3d repeats = Vector3d::Zero();       ///< number of consecutive repetitions of each coordinate

  /// Adds a fix. One that is older than the last is ignored.
  void add(TimeNs time_ns, const Vector3d& position_m);
  /// Largest noise that agrees with the scatter (m²).
  [[nodiscard]] Vector3d max_m2() const;
  /// Noise of rounded coordinates (m²).
  [[nodiscard]] Vector3d rounding_m2() const;
  /// Noise without the share that the motion may have (m²).
  [[nodiscard]] Vector3d noise_m2() const;
  bool operator==(const FixScatter&) const = default;

private:
  void add_steps(const Vector3d& position_m);
  void add_error(const Vector3d& sample_m2);
  [[nodiscard]] Vector3d mean_m2() const;  // horizontal and vertical mean
};

/// Variances of fixes per range of the quality percentage, horizontal and vertical, and of headings.
struct MeasurementNoise {
  static constexpr int bin_count = 5;
  struct Bin {
    AdaptiveVariance horizontal_m2;
    AdaptiveVariance vertical_m2;
    bool operator==(const Bin&) const = default;
  };
  Bin any_quality;
  std::array<Bin, bin_count> bins;
  AdaptiveVariance heading_rad2;
  Correlation correlation;  ///< correlation of the fixes' innovations
  FixScatter scatter;

  MeasurementNoise();

  /// Begins with this horizontal deviation of a fix instead of with the usual guess.
  void start_from(double fix_std_m);

  /// Covariance of a fix of this quality; a negative quality is unknown.
  [[nodiscard]] Eigen::Matrix3d fix_covariance_m2(double quality_percent) const;

  /// Adds the residual of a fix after its correction, and the variance of the prediction then.
  void add_fix(double quality_percent, const Vector3d& residual_m, const Vector3d& prediction_variance_m2,
               bool at_rest);
  /// Adds the innovation of a rejected fix that counts as noise.
  void add_rejected_fix(double quality_percent, const Vector3d& innovation_m);
  void add_heading(double residual_rad, double prediction_variance_rad2, bool at_rest);

  bool operator==(const MeasurementNoise&) const = default;
};

void for_each_field(IsFieldsOf<MeasurementNoise::Bin> auto& bin, const auto& visit) {
  visit("horizontal_m2", bin.horizontal_m2.variance);
  visit("horizontal_samples", bin.horizontal_m2.samples);
  visit("horizontal_motion_m2", bin.horizontal_m2.motion_variance);
  visit("vertical_m2", bin.vertical_m2.variance);
  visit("vertical_samples", bin.vertical_m2.samples);
  visit("vertical_motion_m2", bin.vertical_m2.motion_variance);
}

void for_each_field(IsFieldsOf<Correlation> auto& correlation, const auto& visit) {
  visit("last", correlation.last);
  visit("product", correlation.product);
  visit("square", correlation.square);
}

void for_each_field(IsFieldsOf<FixScatter> auto& scatter, const auto& visit) {
  visit("last_m", scatter.last_m);
  visit("before_m", scatter.before_m);
  visit("last_ns", scatter.last_ns);
  visit("before_ns", scatter.before_ns);
  visit("samples", scatter.samples);
  visit("variance_m2", scatter.variance_m2);
  visit("motion_m2", scatter.motion_m2);
  visit("resolution_m", scatter.resolution_m);
  visit("repeats", scatter.repeats);
}

void for_each_field(IsFieldsOf<MeasurementNoise> auto& noise, const auto& visit) {
  visit("any_quality", noise.any_quality);
  visit("bins", noise.bins);
  visit("correlation", noise.correlation);
  visit("scatter", noise.scatter);
  visit("heading_rad2", noise.heading_rad2.variance);
  visit("heading_samples", noise.heading_rad2.samples);
  visit("heading_motion_rad2", noise.heading_rad2.motion_variance);
}

}  // namespace sonopose::estimation::kalman
