#include "calibration/fit/ellipsoid.hpp"

#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <utility>

namespace sonopose::calibration::fit::detail {

using Eigen::Index;
using Eigen::VectorXd;

Matrix3d soft_iron_of(const VectorXd& p) {
  return Matrix3d{{p[0], p[1], p[2]}, {p[1], p[3], p[4]}, {p[2], p[4], p[5]}};
}

namespace {

VectorXd parameters_of(const Matrix3d& s, const Vector3d& h) {
  VectorXd p(9);
  p << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2), h;
  return p;
}

/// Residuals (|S·m − h| − 1) / ∛det S and their derivatives; not finite unless S is positive. Without the
/// divisor, S = 0 with an h of length 1 would fit everything.
Linearisation linearised(const Points& points, const VectorXd& parameters) {
  const Matrix3d soft_iron = soft_iron_of(parameters);
  const Vector3d hard_iron = parameters.tail<3>();
  const double size = std::cbrt(soft_iron.determinant());
  const auto rows = static_cast<Index>(points.size());
  Linearisation found{VectorXd(rows), Eigen::MatrixXd(rows, 9)};
  if (!(size > 0.0)) {
    found.residuals.setConstant(std::numeric_limits<double>::quiet_NaN());
    return found;
  }
  const Matrix3d inverse = soft_iron.inverse();
  VectorXd by_size = VectorXd::Zero(9);  // derivatives of ln ∛det S
  by_size.head<6>() << inverse(0, 0), 2.0 * inverse(0, 1), 2.0 * inverse(0, 2), inverse(1, 1),
      2.0 * inverse(1, 2), inverse(2, 2);
  by_size /= 3.0;
  for (Index row = 0; row < rows; ++row) {
    const Vector3d& m = points[static_cast<std::size_t>(row)];
    const Vector3d corrected = soft_iron * m - hard_iron;
    const Vector3d d = corrected.normalized();
    found.residuals[row] = (corrected.norm() - 1.0) / size;
    found.jacobian.row(row) << d.x() * m.x(), d.x() * m.y() + d.y() * m.x(), d.x() * m.z() + d.z() * m.x(),
        d.y() * m.y(), d.y() * m.z() + d.z() * m.y(), d.z() * m.z(), -d.transpose();
    found.jacobian.row(row) = found.jacobian.row(row) / size - found.residuals[row] * by_size.transpose();
  }
  return found;
}

}  // namespace

VectorXd ellipsoid_residuals(const Points& points, const VectorXd& parameters) {
  return linearised(points, parameters).residuals;
}

VectorXd ellipsoid_start(const Points& points) {
  constexpr double max_axis_ratio = 5.0;  // ratio of its axes
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
  const VectorXd quadric = solve_symmetric(normal, right);
  const Matrix3d q = soft_iron_of(quadric);
  const Vector3d centre = -(q.inverse() * Vector3d(quadric.tail<3>()));
  const double size = 1.0 + centre.dot(q * centre);
  const SymmetricEigen eigen = eigen_of(q / size);
  const Vector3d squares = eigen.values;
  const bool is_ellipsoid = squares.allFinite() && squares[0] * max_axis_ratio * max_axis_ratio > squares[2];
  if (!is_ellipsoid) return parameters_of(Matrix3d::Identity() / radius, mean / radius);
  const Matrix3d axes = eigen.vectors;
  const Matrix3d root = axes * squares.cwiseSqrt().asDiagonal() * axes.transpose();
  return parameters_of(root, root * (mean + centre));
}

Solution fit_ellipsoid(const Points& points, VectorXd start) {
  return minimise([&points](const VectorXd& at) { return linearised(points, at); }, std::move(start));
}

}  // namespace sonopose::calibration::fit::detail
