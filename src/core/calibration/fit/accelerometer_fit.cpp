#include "calibration/fit/fit_support.hpp"
#include "calibration/fit/inertial_fit.hpp"
#include "calibration/fit/least_squares.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace sonopose::calibration::fit {
namespace {

using detail::Linearisation;
using detail::Solution;
using Eigen::Index;
using Eigen::VectorXd;

/// Condition above which the orientations do not determine the parameters: noise of 1 per mille of gravity
/// would become more than a tenth.
constexpr double max_accelerometer_condition = 100.0;

// Parameters in the fit's order: offset in units of the mean reading, sensitivity in units of gravity over
// that, lower triangle of the misalignment.
constexpr std::array<std::string_view, 9> accelerometer_names{
    "the offset of X",      "the offset of Y",      "the offset of Z",
    "the sensitivity of X", "the sensitivity of Y", "the sensitivity of Z",
    "the misalignment yx",  "the misalignment zx",  "the misalignment zy"};
constexpr Index count_without_misalignment = 6;

Matrix3d misalignment_of(const VectorXd& parameters) {
  Matrix3d matrix = Matrix3d::Identity();
  if (parameters.size() > count_without_misalignment) {
    matrix(1, 0) = parameters[6];
    matrix(2, 0) = parameters[7];
    matrix(2, 1) = parameters[8];
  }
  return matrix;
}

/// Residuals |M·s·(f − b)| / g − 1 and their derivatives; f and b in units of `unit_mps2`.
Linearisation linearised(std::span<const StillInterval> intervals, double unit_mps2,
                         const VectorXd& parameters) {
  const Vector3d offset = parameters.head<3>();
  const Vector3d sensitivity = parameters.segment<3>(3);
  const Matrix3d misalignment = misalignment_of(parameters);
  const auto rows = static_cast<Index>(intervals.size());
  Linearisation found{VectorXd(rows), Eigen::MatrixXd(rows, parameters.size())};
  for (Index row = 0; row < rows; ++row) {
    const Vector3d force = intervals[static_cast<std::size_t>(row)].mean_force_mps2 / unit_mps2 - offset;
    const Vector3d scaled = sensitivity.cwiseProduct(force);
    const Vector3d corrected = misalignment * scaled;
    const Vector3d direction = corrected.normalized();
    found.residuals[row] = corrected.norm() - 1.0;
    const Vector3d by_scaled = misalignment.transpose() * direction;
    found.jacobian.row(row).head<3>() = -by_scaled.cwiseProduct(sensitivity).transpose();
    found.jacobian.row(row).segment<3>(3) = by_scaled.cwiseProduct(force).transpose();
    if (parameters.size() > count_without_misalignment) {
      found.jacobian.row(row).tail<3>() << direction.y() * scaled.x(), direction.z() * scaled.x(),
          direction.z() * scaled.y();
    }
  }
  return found;
}

double mean_norm_mps2(std::span<const StillInterval> intervals) {
  double sum_mps2 = 0.0;
  for (const StillInterval& interval : intervals) sum_mps2 += interval.mean_force_mps2.norm();
  return sum_mps2 / static_cast<double>(intervals.size());
}

Solution solve(std::span<const StillInterval> intervals, Index parameters) {
  const double unit_mps2 = mean_norm_mps2(intervals);
  double variance = 0.0;
  for (const StillInterval& interval : intervals) {
    variance += std::pow(interval.force_error_mps2 / unit_mps2, 2) / static_cast<double>(intervals.size());
  }
  VectorXd start = VectorXd::Zero(parameters);
  start.segment<3>(3).setOnes();
  Solution solution = detail::minimise(
      [&](const VectorXd& at) { return linearised(intervals, unit_mps2, at); }, std::move(start), variance);
  // Factors from the fit's units to m/s².
  VectorXd factors = VectorXd::Ones(parameters);
  factors.head<3>().setConstant(unit_mps2);
  factors.segment<3>(3).setConstant(standard_gravity_mps2 / unit_mps2);
  solution.parameters = factors.cwiseProduct(solution.parameters);
  solution.covariance = factors.asDiagonal() * solution.covariance * factors.asDiagonal();
  return solution;
}

AccelerometerSettings settings_of(const VectorXd& parameters, AccelerometerSettings settings) {
  settings.offset_x_mps2 = parameters[0];
  settings.offset_y_mps2 = parameters[1];
  settings.offset_z_mps2 = parameters[2];
  settings.sensitivity_x = parameters[3];
  settings.sensitivity_y = parameters[4];
  settings.sensitivity_z = parameters[5];
  if (parameters.size() > count_without_misalignment) {
    settings.misalignment_yx = parameters[6];
    settings.misalignment_zx = parameters[7];
    settings.misalignment_zy = parameters[8];
  }
  return settings;
}

double rms_before(std::span<const StillInterval> intervals) {
  double sum = 0.0;
  for (const StillInterval& interval : intervals) {
    const double residual_mps2 = interval.mean_force_mps2.norm() - standard_gravity_mps2;
    sum += residual_mps2 * residual_mps2;
  }
  return std::sqrt(sum / static_cast<double>(intervals.size()));
}

[[noreturn]] void refuse_too_few(std::size_t orientations, std::size_t periods) {
  const double min_deg = std::round(min_orientation_angle_rad / geometry::radians_per_degree);
  throw CalibrationError(
      "orientations at least " + detail::text_of(min_deg) +
      " degrees apart in which the sensor was held still: " + std::to_string(orientations) + " found, in " +
      std::to_string(periods) + " still periods; " + std::to_string(min_orientations) +
      " are needed for offset and sensitivity, " + std::to_string(min_orientations_with_misalignment) +
      " for misalignment too: hold it still for 2 s in each; more orientations are more accurate");
}

/// Solves for all nine parameters. Returns nothing, and the reason, if it cannot.
std::optional<Solution> solve_with_misalignment(std::span<const StillInterval> intervals,
                                                std::size_t orientations, std::string& why_without) {
  if (orientations < min_orientations_with_misalignment) {
    why_without = std::to_string(orientations) + " orientations were found, " +
                  std::to_string(min_orientations_with_misalignment) + " are needed";
    return std::nullopt;
  }
  Solution solution = solve(intervals, static_cast<Index>(accelerometer_names.size()));
  if (solution.condition <= max_accelerometer_condition) return solution;
  why_without = "the orientations do not determine it, least of all " +
                std::string(detail::weakest_of(solution, accelerometer_names)) +
                ": hold the sensor also on its edges and corners";
  return std::nullopt;
}

}  // namespace

AccelerometerFit fit_accelerometer(std::span<const StillInterval> intervals) {
  AccelerometerFit fit;
  fit.orientations = count_orientations(intervals, min_orientation_angle_rad);
  if (fit.orientations < min_orientations) refuse_too_few(fit.orientations, intervals.size());
  std::optional<Solution> solution = solve_with_misalignment(intervals, fit.orientations, fit.why_without);
  fit.with_misalignment = solution.has_value();
  if (!solution) solution = solve(intervals, count_without_misalignment);
  if (!(solution->condition <= max_accelerometer_condition)) {
    throw CalibrationError("the " + std::to_string(fit.orientations) +
                           " orientations do not determine offset and sensitivity, least of all " +
                           std::string(detail::weakest_of(*solution, accelerometer_names)) +
                           ": hold the sensor still with each of its six sides up");
  }
  AccelerometerSettings zero;
  zero.sensitivity_x = zero.sensitivity_y = zero.sensitivity_z = 0.0;
  fit.settings = settings_of(solution->parameters, AccelerometerSettings{});
  fit.standard_errors = settings_of(solution->standard_errors(), zero);
  detail::check_ranges(fit.settings);
  fit.rms_before_mps2 = rms_before(intervals);
  const VectorXd residuals_mps2 = standard_gravity_mps2 * solution->residuals;
  fit.rms_after_mps2 = std::sqrt(residuals_mps2.squaredNorm() / static_cast<double>(residuals_mps2.size()));
  Index worst = 0;
  fit.worst_after_mps2 = residuals_mps2.cwiseAbs().maxCoeff(&worst);
  fit.worst_period = static_cast<std::size_t>(worst);
  return fit;
}

}  // namespace sonopose::calibration::fit
