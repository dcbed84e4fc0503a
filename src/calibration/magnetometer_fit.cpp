#include "ellipsoid.hpp"
#include "fit_support.hpp"
#include <sonopose/calibration/magnetometer_fit.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <vector>

namespace sonopose::calibration {
namespace {

using detail::Points;
using detail::soft_iron_of;
using detail::Solution;
using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t least_samples = 50;
constexpr double largest_condition = 60.0;
constexpr double largest_axis_ratio = 5.0;
constexpr double largest_relative_rms = 0.2;

// The parameters in the fit's order: S, then h, both for readings in units of the field's strength.
constexpr std::array<std::string_view, 9> names{"soft iron xx", "soft iron xy", "soft iron xz",
                                                "soft iron yy", "soft iron yz", "soft iron zz",
                                                "hard iron x",  "hard iron y",  "hard iron z"};

/// `share` of the values lie below it.
double quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

/// Where nearly all readings lie: about the middle of the ellipsoid, and half of its widest span.
struct Span {
  Vector3d middle_ut = Vector3d::Zero();
  double half_ut = 0;
};

Span span_of(const Points& points_ut) {
  Span found;
  for (Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values_ut;
    for (const Vector3d& point_ut : points_ut) values_ut.push_back(point_ut[axis]);
    const double low_ut = quantile(values_ut, 0.01);
    const double high_ut = quantile(values_ut, 0.99);
    found.middle_ut[axis] = 0.5 * (low_ut + high_ut);
    found.half_ut = std::max(found.half_ut, 0.5 * (high_ut - low_ut));
  }
  return found;
}

/// At most a few readings from each small cube, so that a long rest in one direction counts no more than a
/// quick turn through another. From the span's middle, in units of its half.
Points thinned(const Points& points_ut, const Span& span) {
  constexpr int most_per_cell = 5;
  constexpr double cell = 0.1;
  std::map<std::array<std::int64_t, 3>, int> seen;
  Points kept;
  for (const Vector3d& point_ut : points_ut) {
    const Vector3d point = (point_ut - span.middle_ut) / span.half_ut;
    std::array<std::int64_t, 3> key{};
    for (std::size_t i = 0; i < 3; ++i) {
      key[i] = static_cast<std::int64_t>(std::floor(point[static_cast<Index>(i)] / cell));
    }
    if (seen[key]++ < most_per_cell) kept.push_back(point);
  }
  return kept;
}

/// Share of 48 equal parts of the sphere in which a corrected reading points.
double coverage_of(const Points& points, const VectorXd& parameters) {
  constexpr int bands = 6;
  constexpr int sectors = 8;
  std::array<bool, bands * sectors> seen{};
  for (const Vector3d& point : points) {
    const Vector3d d = (soft_iron_of(parameters) * point - parameters.tail<3>()).normalized();
    const double turn = (std::atan2(d.y(), d.x()) + std::numbers::pi) / (2.0 * std::numbers::pi);
    const int band = std::clamp(static_cast<int>(0.5 * (d.z() + 1.0) * bands), 0, bands - 1);
    const int sector = std::clamp(static_cast<int>(turn * sectors), 0, sectors - 1);
    seen[static_cast<std::size_t>(band * sectors + sector)] = true;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
}

/// Without the readings whose residual is far outside what most of them have.
Points without_outliers(const Points& points, const VectorXd& parameters) {
  constexpr double sigmas = 4.0;
  constexpr double sigma_per_median = 1.4826;  // of absolute values of a Gaussian
  const VectorXd residuals = detail::ellipsoid_residuals(points, parameters);
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const double limit = sigmas * sigma_per_median * quantile(sizes, 0.5);
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (sizes[i] <= limit) kept.push_back(points[i]);
  }
  return kept;
}

void check_coverage(const Solution& solution, double coverage) {
  if (solution.condition <= largest_condition) return;
  throw CalibrationError("the directions seen, " + detail::text_of(std::round(100.0 * coverage)) +
                         " % of the sphere, do not determine the ellipsoid, least of all " +
                         std::string(detail::weakest_of(solution, names)) +
                         ": turn the sensor slowly about all of its axes, until each side has pointed in "
                         "every direction");
}

void check_ellipsoid(const Vector3d& semi_axes_ut, double relative_rms) {
  const double ratio = semi_axes_ut[0] / semi_axes_ut[2];
  if (!(ratio <= largest_axis_ratio)) {
    throw CalibrationError("the readings lie on no ellipsoid that iron can make: its axes would be " +
                           detail::text_of(ratio) + " to 1, where " + detail::text_of(largest_axis_ratio) +
                           " is the most: was the whole sphere seen, and is the sensor's range enough?");
  }
  if (!(relative_rms <= largest_relative_rms)) {
    throw CalibrationError("the readings lie on no ellipsoid: they miss the best one by " +
                           detail::text_of(100.0 * relative_rms) + " % of the field, where " +
                           detail::text_of(100.0 * largest_relative_rms) +
                           " % is the most: record where no iron, current or magnet is near, and turn the "
                           "sensor through all directions");
  }
}

/// S and h of readings in units of one strength, for readings in µT and a field of another: a factor for
/// each.
MagnetometerSettings settings_of(const VectorXd& parameters, double soft_factor, double hard_factor) {
  MagnetometerSettings settings;
  settings.soft_iron_xx = parameters[0] * soft_factor;
  settings.soft_iron_xy = parameters[1] * soft_factor;
  settings.soft_iron_xz = parameters[2] * soft_factor;
  settings.soft_iron_yy = parameters[3] * soft_factor;
  settings.soft_iron_yz = parameters[4] * soft_factor;
  settings.soft_iron_zz = parameters[5] * soft_factor;
  settings.hard_iron_x_ut = parameters[6] * hard_factor;
  settings.hard_iron_y_ut = parameters[7] * hard_factor;
  settings.hard_iron_z_ut = parameters[8] * hard_factor;
  return settings;
}

/// All readings, in µT.
Points fields_of(std::span<const ImuSample> imu) {
  constexpr double microtesla_per_tesla = 1e6;
  Points fields_ut;
  for (const ImuSample& sample : imu) {
    if (sample.magnetic_field_body_t && sample.magnetic_field_body_t->allFinite()) {
      fields_ut.push_back(microtesla_per_tesla * *sample.magnetic_field_body_t);
    }
  }
  if (fields_ut.size() < least_samples) {
    throw CalibrationError(std::to_string(fields_ut.size()) + " samples have a magnetic field; " +
                           std::to_string(least_samples) + " are needed");
  }
  return fields_ut;
}

/// Spread of the raw readings' strengths. The points stand as thinned() left them.
double rms_of_norms_ut(const Points& points, const Span& span) {
  const auto count = static_cast<double>(points.size());
  const auto norm_ut = [&span](const Vector3d& point) {
    return (span.half_ut * point + span.middle_ut).norm();
  };
  double mean_ut = 0.0;
  for (const Vector3d& point : points) mean_ut += norm_ut(point) / count;
  double variance = 0.0;
  for (const Vector3d& point : points) variance += std::pow(norm_ut(point) - mean_ut, 2) / count;
  return std::sqrt(variance);
}

/// For readings from zero instead of from `middle`, in the same unit: h grows by S·middle.
void move_to_zero(Solution& solution, const Vector3d& middle) {
  Eigen::MatrixXd change = Eigen::MatrixXd::Identity(9, 9);
  change.bottomLeftCorner<3, 6>() << middle.x(), middle.y(), middle.z(), 0.0, 0.0, 0.0, 0.0, middle.x(), 0.0,
      middle.y(), middle.z(), 0.0, 0.0, 0.0, middle.x(), 0.0, middle.y(), middle.z();
  solution.parameters = change * solution.parameters;
  solution.covariance = change * solution.covariance * change.transpose();
}

/// The solution in µT. Readings are in units of `unit_ut`.
void fill(MagnetometerFit& fit, const Solution& solution, double unit_ut, std::optional<double> field_ut) {
  const Matrix3d soft_iron = soft_iron_of(solution.parameters);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(soft_iron);  // in rising order
  fit.semi_axes_ut = unit_ut * eigen.eigenvalues().cwiseMax(0.0).cwiseInverse();
  const double rms =
      std::sqrt(solution.residuals.squaredNorm() / static_cast<double>(solution.residuals.size()));
  const double relative_rms = rms * std::cbrt(soft_iron.determinant());
  check_ellipsoid(fit.semi_axes_ut, relative_rms);
  fit.centre_ut = unit_ut * soft_iron.inverse() * solution.parameters.tail<3>();
  fit.field_ut = field_ut.value_or(std::cbrt(fit.semi_axes_ut.prod()));
  fit.settings = settings_of(solution.parameters, fit.field_ut / unit_ut, fit.field_ut);
  fit.standard_errors = settings_of(solution.standard_errors(), fit.field_ut / unit_ut, fit.field_ut);
  detail::check_ranges(fit.settings);
  fit.rms_after_ut = fit.field_ut * relative_rms;
}

}  // namespace

MagnetometerFit fit_magnetometer(std::span<const ImuSample> imu, std::optional<double> field_ut) {
  const Points all_ut = fields_of(imu);
  const Span span = span_of(all_ut);
  if (!(span.half_ut > 0.0)) throw CalibrationError("the magnetic field is the same in every sample");
  const Points points = thinned(all_ut, span);
  Solution solution = detail::fit_ellipsoid(points, detail::ellipsoid_start(points));
  const Points good = without_outliers(points, solution.parameters);
  solution = detail::fit_ellipsoid(good, solution.parameters);

  MagnetometerFit fit;
  fit.samples = all_ut.size();
  fit.used = good.size();
  fit.outliers = points.size() - good.size();
  fit.coverage = coverage_of(good, solution.parameters);
  check_coverage(solution, fit.coverage);
  fit.rms_before_ut = rms_of_norms_ut(good, span);
  move_to_zero(solution, span.middle_ut / span.half_ut);
  fill(fit, solution, span.half_ut, field_ut);
  return fit;
}

}  // namespace sonopose::calibration
