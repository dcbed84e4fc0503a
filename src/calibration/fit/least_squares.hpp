#pragma once
/// \file
/// Nonlinear least squares by Levenberg and Marquardt, and the decompositions of dense matrices, which take
/// long to compile: only here. Private to this folder.

#include <Eigen/Core>

#include <functional>

namespace sonopose::calibration::fit::detail {

/// Residuals at some parameters and their derivatives, a row per residual. All parameters should be of about
/// the same size, or the condition says nothing.
struct Linearisation {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};
using Model = std::function<Linearisation(const Eigen::VectorXd& parameters)>;

struct Solution {
  Eigen::VectorXd parameters;
  Eigen::VectorXd residuals = {};
  Eigen::MatrixXd covariance = {};  ///< of the parameters
  double condition = 0;             ///< largest to smallest singular value of the derivatives; maybe infinite
  Eigen::VectorXd weakest = {};     ///< the direction of parameters that the residuals determine least

  [[nodiscard]] Eigen::VectorXd standard_errors() const { return covariance.diagonal().cwiseSqrt(); }
};

/// The parameters with the least sum of squared residuals near `start`. The residuals' scatter gives the
/// standard errors, but never less than `least_variance` of a residual: where there are hardly more residuals
/// than parameters, their scatter says little.
Solution minimise(const Model& model, Eigen::VectorXd start, double least_variance = 0.0);

/// The solution in parameters that are `change` times its own; its condition and weakest direction stay as
/// they are.
void transform(Solution& solution, const Eigen::MatrixXd& change);

/// Eigenvalues in rising order, and a column of length 1 for each.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen eigen_of(const Eigen::MatrixXd& symmetric);

/// Solves symmetric·x = right.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& symmetric, const Eigen::VectorXd& right);

/// A model whose derivatives are taken by central differences of `step`.
Model differentiated(std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals, double step);

}  // namespace sonopose::calibration::fit::detail
