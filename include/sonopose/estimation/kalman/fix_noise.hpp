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
  /// (1 − K)² with the gain K of the correction: 1 − K of the noise is left in the residual.
  double weight = 0;

  /// `prediction_variance` is that after the correction. A stray residual counts as one of three deviations.
  VarianceSample(double squared_residual, double prediction_variance, double noise_variance);
};

/// Limits and memory of a learned variance.
struct VarianceLimits {
  double initial = 0;
  double least = 0;
  double most = 0;
  double memory_samples = 0;
};

/// A running variance. It begins with a prior guess and forgets.
struct AdaptiveVariance {
  double variance = 0;
  double samples = 0;          ///< behind it, up to the memory
  double motion_variance = 0;  ///< without the samples of a body at rest; 0: not known

  /// `first` is the motion variance before the first sample.
  void add(const VarianceSample& sample, const VarianceLimits& limits, double first);
  /// The errors of a body at rest repeat: they may show that the noise is large, but not that it is small. So
  /// the variance does not fall below `least`. A large sample raises it; then others count as well.
  void add_at_rest(const VarianceSample& sample, const VarianceLimits& limits, double least);
  /// Adds a sample of a rejected fix. The samples so far then count as a few. It says nothing certain, so the
  /// motion variance stays: at rest the variance returns to it.
  void add_doubtful(const VarianceSample& sample, const VarianceLimits& limits);
  bool operator==(const AdaptiveVariance&) const = default;

private:
  void count(const VarianceSample& sample, double most_samples);
};

/// The correlation of an innovation with the one before. It is zero if the gain is right; errors of the
/// motion make it positive, whatever their size (Mehra, On the Identification of Variances and Adaptive
/// Kalman Filtering, 1970).
struct Correlation {
  Vector3d last = Vector3d::Zero();  ///< normalised innovation
  double product = 0;                ///< mean of the products
  double square = 1;                 ///< mean of the squares

  void add(const Vector3d& value_m, const Eigen::Matrix3d& covariance_m2);
  /// The share of the squares that is white.
  [[nodiscard]] double white_share() const;
  bool operator==(const Correlation&) const = default;
};

/// The noise that the fixes show by themselves, whatever the IMU says: the distance of each from the line
/// through the two before. It contains what the motion adds, so the noise of a fix is hardly more.
struct FixScatter {
  static constexpr int least_samples = 6;  ///< that say something
  static constexpr int most_samples = 16;  ///< that count; then a running median begins

  Vector3d last_m = Vector3d::Zero();
  Vector3d before_m = Vector3d::Zero();
  TimeNs last_ns = 0;
  TimeNs before_ns = 0;  ///< 0: fewer than two fixes
  int samples = 0;
  Vector3d variance_m2 = Vector3d::Zero();   ///< of a fix, if there were no acceleration
  double motion_m2 = 0;                      ///< share of it that the motion may have
  Vector3d resolution_m = Vector3d::Zero();  ///< steps of coordinates that repeat; 0: none

  /// Adds a fix. One that is older than the last is ignored.
  void add(TimeNs time_ns, const Vector3d& position_m);
  /// The largest noise that agrees with it, m².
  [[nodiscard]] Vector3d most_m2() const;
  /// The noise of rounded coordinates, m².
  [[nodiscard]] Vector3d rounding_m2() const;
  /// The noise without the share that the motion may have, m².
  [[nodiscard]] Vector3d noise_m2() const;
  bool operator==(const FixScatter&) const = default;

private:
  void add_steps(const Vector3d& position_m);
  void add_error(const Vector3d& sample_m2);
  [[nodiscard]] Vector3d mean_m2() const;  // horizontal and vertical
};

/// The variances of the fixes per range of the quality percentage, horizontal and vertical, and of headings.
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
  Correlation correlation;  ///< of the fixes
  FixScatter scatter;

  MeasurementNoise();

  /// The covariance of a fix of this quality; negative: unknown.
  [[nodiscard]] Eigen::Matrix3d fix_covariance_m2(double quality_percent) const;

  /// Adds the residual of a fix after its correction, and how uncertain the prediction then is.
  void add_fix(double quality_percent, const Vector3d& residual_m, const Vector3d& prediction_variance_m2,
               bool at_rest);
  /// Adds the innovation of a rejected fix that is taken for noise.
  void add_scattered_fix(double quality_percent, const Vector3d& innovation_m);
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
