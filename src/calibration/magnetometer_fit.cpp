#include "fit_support.hpp"
#include "least_squares.hpp"
#include <sonopose/calibration/magnetometer_fit.hpp>

#include <Eigen/Cholesky>
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

using detail::Linearisation;
using detail::Solution;
using Eigen::Index;
using Eigen::VectorXd;
using Points = std::vector<Vector3d>;

constexpr std::size_t least_samples = 50;
constexpr double largest_condition = 60.0;
constexpr double largest_axis_ratio = 5.0;
constexpr double largest_relative_rms = 0.2;

// The parameters in the fit's order: S, then h, both for readings in units of the field's strength.
constexpr std::array<std::string_view, 9> names{"soft iron xx", "soft iron xy", "soft iron xz",
                                                "soft iron yy", "soft iron yz", "soft iron zz",
                                                "hard iron x",  "hard iron y",  "hard iron z"};

Matrix3d soft_iron_of(const VectorXd& p) {
  return Matrix3d{{p[0], p[1], p[2]}, {p[1], p[3], p[4]}, {p[2], p[4], p[5]}};
}

VectorXd parameters_of(const Matrix3d& s, const Vector3d& h) {
  VectorXd p(9);
  p << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2), h;
  return p;
}

/// |S·m − h| − 1 and its derivatives.
Linearisation linearised(const Points& points, const VectorXd& parameters) {
  const Matrix3d soft_iron = soft_iron_of(parameters);
  const Vector3d hard_iron = parameters.tail<3>();
  const auto rows = static_cast<Index>(points.size());
  Linearisation found{VectorXd(rows), Eigen::MatrixXd(rows, 9)};
  for (Index row = 0; row < rows; ++row) {
    const Vector3d& m = points[static_cast<std::size_t>(row)];
    const Vector3d corrected = soft_iron * m - hard_iron;
    const Vector3d d = corrected.normalized();
    found.residuals[row] = corrected.norm() - 1.0;
    found.jacobian.row(row) << d.x() * m.x(), d.x() * m.y() + d.y() * m.x(), d.x() * m.z() + d.z() * m.x(),
        d.y() * m.y(), d.y() * m.z() + d.z() * m.y(), d.z() * m.z(), -d.transpose();
  }
  return found;
}

/// The quadric m·Q·m + 2·n·m = 1 with the least squares of its equation, as S and h; a sphere about the mean
/// where it is no ellipsoid.
VectorXd starting_point(const Points& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> right = Eigen::Matrix<double, 9, 1>::Zero();
  double radius = 0.0;
  for (const Vector3d& point : points) {
    const Vector3d m = point - mean;
    Eigen::Matrix<double, 9, 1> row;
    row << m.x() * m.x(), 2.0 * m.x() * m.y(), 2.0 * m.x() * m.z(), m.y() * m.y(), 2.0 * m.y() * m.z(),
        m.z() * m.z(), 2.0 * m;
    normal += row * row.transpose();
    right += row;
    radius += m.norm() / static_cast<double>(points.size());
  }
  const VectorXd quadric = normal.ldlt().solve(right);
  const Matrix3d q = soft_iron_of(quadric);
  const Vector3d centre = -q.fullPivLu().solve(Vector3d(quadric.tail<3>()));
  const double size = 1.0 + centre.dot(q * centre);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(Matrix3d(q / size));
  const Vector3d squares = eigen.eigenvalues();
  const bool is_ellipsoid =
      squares.allFinite() && squares[0] * largest_axis_ratio * largest_axis_ratio > squares[2];
  if (!is_ellipsoid) return parameters_of(Matrix3d::Identity() / radius, mean / radius);
  const Matrix3d root = eigen.operatorSqrt();
  return parameters_of(root, root * (mean + centre));
}

Solution solve(const Points& points, VectorXd start) {
  return detail::minimise([&points](const VectorXd& at) { return linearised(points, at); }, std::move(start));
}

/// At most a few readings from each small cube, so that a long rest in one direction counts no more than a
/// quick turn through another.
Points thinned(const Points& points, double field) {
  constexpr int most_per_cell = 5;
  constexpr double cell = 0.1;
  std::map<std::array<std::int64_t, 3>, int> seen;
  Points kept;
  for (const Vector3d& point : points) {
    std::array<std::int64_t, 3> key{};
    for (std::size_t i = 0; i < 3; ++i) {
      key[i] = static_cast<std::int64_t>(std::floor(point[static_cast<Index>(i)] / (cell * field)));
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

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Without the readings whose residual is far outside what most of them have.
Points without_outliers(const Points& points, const VectorXd& parameters) {
  constexpr double sigmas = 4.0;
  constexpr double sigma_per_median = 1.4826;  // of absolute values of a Gaussian
  const VectorXd residuals = linearised(points, parameters).residuals;
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const double limit = sigmas * sigma_per_median * median_of(sizes);
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
                           " % is the most: record where no iron, current or magnet is near");
  }
}

MagnetometerSettings settings_of(const VectorXd& parameters, double field_ut) {
  MagnetometerSettings settings;
  settings.soft_iron_xx = parameters[0];
  settings.soft_iron_xy = parameters[1];
  settings.soft_iron_xz = parameters[2];
  settings.soft_iron_yy = parameters[3];
  settings.soft_iron_yz = parameters[4];
  settings.soft_iron_zz = parameters[5];
  settings.hard_iron_x_ut = parameters[6] * field_ut;
  settings.hard_iron_y_ut = parameters[7] * field_ut;
  settings.hard_iron_z_ut = parameters[8] * field_ut;
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

double mean_norm(const Points& points) {
  double sum = 0.0;
  for (const Vector3d& point : points) sum += point.norm();
  return sum / static_cast<double>(points.size());
}

double rms_of_norms(const Points& points, double about) {
  double sum = 0.0;
  for (const Vector3d& point : points) sum += (point.norm() - about) * (point.norm() - about);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

MagnetometerFit fit_magnetometer(std::span<const ImuSample> imu, std::optional<double> field_ut) {
  MagnetometerFit fit;
  const Points all_ut = fields_of(imu);
  fit.samples = all_ut.size();
  Points points = thinned(all_ut, mean_norm(all_ut));
  fit.field_ut = field_ut.value_or(mean_norm(points));
  if (!(fit.field_ut > 0.0)) throw CalibrationError("the magnetic field is zero in every sample");
  for (Vector3d& point : points) point /= fit.field_ut;

  Solution solution = solve(points, starting_point(points));
  const Points good = without_outliers(points, solution.parameters);
  fit.used = good.size();
  fit.outliers = points.size() - good.size();
  solution = solve(good, solution.parameters);
  fit.coverage = coverage_of(good, solution.parameters);
  check_coverage(solution, fit.coverage);

  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(soft_iron_of(solution.parameters));
  fit.semi_axes_ut = fit.field_ut * eigen.eigenvalues().cwiseMax(0.0).cwiseInverse();
  const double relative_rms = std::sqrt(solution.residuals.squaredNorm() / static_cast<double>(good.size()));
  check_ellipsoid(fit.semi_axes_ut, relative_rms);
  const VectorXd& parameters = solution.parameters;
  fit.centre_ut = fit.field_ut * soft_iron_of(parameters).inverse() * parameters.tail<3>();
  fit.settings = settings_of(parameters, fit.field_ut);
  fit.standard_errors = settings_of(solution.standard_errors, fit.field_ut);
  detail::check_ranges(fit.settings);
  fit.rms_before_ut = fit.field_ut * rms_of_norms(good, mean_norm(good));
  fit.rms_after_ut = fit.field_ut * relative_rms;
  return fit;
}

}  // namespace sonopose::calibration
