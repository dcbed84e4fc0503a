#include "calibration/fit/magnetometer_fit.hpp"

#include "calibration/fit/ellipsoid.hpp"
#include "calibration/fit/fit_support.hpp"
#include "calibration/fit/magnetometer_readings.hpp"
#include <sonopose/statistics/quantile.hpp>

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <vector>

namespace sonopose::calibration::fit {
namespace {

using detail::Points;
using detail::soft_iron_of;
using detail::Solution;
using detail::Span;
using Eigen::VectorXd;

constexpr double max_magnetometer_condition = 60.0;
constexpr double max_axis_ratio = 5.0;
constexpr double max_relative_rms = 0.2;

// Parameters in the fit's order: S, then h, both for readings in units of the field's strength.
constexpr std::array<std::string_view, 9> magnetometer_names{"soft iron xx", "soft iron xy", "soft iron xz",
                                                             "soft iron yy", "soft iron yz", "soft iron zz",
                                                             "hard iron x",  "hard iron y",  "hard iron z"};

/// Removes readings whose residual is far outside that of most.
Points without_outliers(const Points& points, const VectorXd& parameters) {
  constexpr double sigmas = 4.0;
  constexpr double sigma_per_median = 1.4826;  // of absolute values of a Gaussian
  const VectorXd residuals = detail::ellipsoid_residuals(points, parameters);
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const double limit = sigmas * sigma_per_median * statistics::quantile(sizes, 0.5);
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (sizes[i] <= limit) kept.push_back(points[i]);
  }
  return kept;
}

void check_coverage(const Solution& solution, double coverage) {
  if (solution.condition <= max_magnetometer_condition) return;
  throw CalibrationError("the measured directions cover " + detail::text_of(std::round(100.0 * coverage)) +
                         " % of the sphere and do not determine the ellipsoid, least of all " +
                         std::string(detail::weakest_of(solution, magnetometer_names)) +
                         ": turn the sensor slowly about all of its axes, until each side has pointed in "
                         "every direction");
}

void check_ellipsoid(const Vector3d& semi_axes_ut, double relative_rms) {
  const double ratio = semi_axes_ut[0] / semi_axes_ut[2];
  if (!(ratio <= max_axis_ratio)) {
    throw CalibrationError("the readings lie on no ellipsoid that iron can cause: its axes have a ratio of " +
                           detail::text_of(ratio) + " to 1, above " + detail::text_of(max_axis_ratio) +
                           " to 1: check that the readings cover the whole sphere within the sensor's range");
  }
  if (!(relative_rms <= max_relative_rms)) {
    throw CalibrationError("the readings lie on no ellipsoid: they deviate from the best one by " +
                           detail::text_of(100.0 * relative_rms) + " % of the field, more than " +
                           detail::text_of(100.0 * max_relative_rms) +
                           " %: record where no iron, current or magnet is near, and turn the "
                           "sensor through all directions");
  }
}

/// Converts S and h from readings in units of one field strength to readings in µT and another strength, by a
/// factor each.
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

/// Spread of the raw readings' strengths, for the points that thinned() kept.
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

/// Refers the solution to zero instead of `middle`, in the same unit: h grows by S·middle.
void move_to_zero(Solution& solution, const Vector3d& middle) {
  Eigen::MatrixXd change = Eigen::MatrixXd::Identity(9, 9);
  change.bottomLeftCorner<3, 6>() << middle.x(), middle.y(), middle.z(), 0.0, 0.0, 0.0, 0.0, middle.x(), 0.0,
      middle.y(), middle.z(), 0.0, 0.0, 0.0, middle.x(), 0.0, middle.y(), middle.z();
  detail::transform(solution, change);
}

/// Writes the solution in µT. Readings are in units of `unit_ut`.
void fill(MagnetometerFit& fit, const Solution& solution, double unit_ut, std::optional<double> field_ut) {
  const Matrix3d soft_iron = soft_iron_of(solution.parameters);
  const Vector3d eigenvalues = detail::eigen_of(soft_iron).values;
  fit.semi_axes_ut = unit_ut * eigenvalues.cwiseMax(0.0).cwiseInverse();
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
  const Points all_ut = detail::fields_of(imu);
  const Points near_ut = detail::without_glitches(all_ut);
  const Span span = detail::span_of(near_ut);
  const Points points = detail::thinned(near_ut, span);
  Solution solution = detail::fit_ellipsoid(points, detail::ellipsoid_start(points));
  const Points good = without_outliers(points, solution.parameters);
  solution = detail::fit_ellipsoid(good, solution.parameters);

  MagnetometerFit fit;
  fit.samples = all_ut.size();
  fit.used = good.size();
  fit.outliers = (all_ut.size() - near_ut.size()) + (points.size() - good.size());
  fit.coverage = detail::coverage_of(good, solution.parameters);
  check_coverage(solution, fit.coverage);
  fit.rms_before_ut = rms_of_norms_ut(good, span);
  move_to_zero(solution, span.middle_ut / span.half_ut);
  fill(fit, solution, span.half_ut, field_ut);
  return fit;
}

}  // namespace sonopose::calibration::fit
