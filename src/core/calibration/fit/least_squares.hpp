#pragma once
/// \file
/// Nonlinear least squares by Levenberg and Marquardt, and the decompositions of dense matrices. They take
/// long to compile, so they are only here. Private to this folder.

#include <Eigen/Core>

#include <functional>

namespace sonopose::calibration::fit::detail {

/// Residuals at some parameters and their derivatives, a row per residual. All parameters should be of
/// similar size; otherwise the condition is meaningless.
struct Linearisation {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};
using Model = std::function<Linearisation(const Eigen::VectorXd& parameters)>;

struct Solution {
  Eigen::VectorXd parameters;
  Eigen::VectorXd residuals = {};
  Eigen::MatrixXd covariance = {};  ///< covariance of the parameters
  double condition = 0;  ///< ratio of largest to smallest singular value of the derivatives; maybe infinite
  Eigen::VectorXd weakest = {};  ///< direction of parameters that the residuals determine least

  [[nodiscard]] Eigen::VectorXd standard_errors() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Finds the parameters with the least sum of squared residuals near `start`. The residuals' scatter gives
/// the standard errors, but at least those of the variance `min_variance`: with hardly more residuals than
/// parameters, the scatter says little.
Solution minimise(const Model& model, Eigen::VectorXd start, double min_variance = 0.0);

/// Converts the solution to parameters that are `change` times its own. Condition and weakest direction stay.
void transform(Solution& solution, const Eigen::MatrixXd& change);

/// Eigenvalues in ascending order, with a column of length 1 for each.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen eigen_of(const Eigen::MatrixXd& symmetric);

/// Solves symmetric·x = right.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::VectorXd& right);

/// A model with derivatives by central differences of `step`.
Model differentiated(std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals, double step);

}  // namespace sonopose::calibration::fit::detail
