#include "calibration/fit/least_squares.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sonopose::calibration::fit::detail {
namespace {

using Eigen::MatrixXd;

MatrixXd product(const MatrixXd& a, const MatrixXd& b) {
  return a * b;
}

MatrixXd normal_of(const MatrixXd& jacobian) {
  return product(jacobian.transpose(), jacobian);
}

void change_basis(MatrixXd& covariance, const MatrixXd& change) {
  covariance = product(change, product(covariance, change.transpose()));
}

/// Sets the errors of the parameters from the derivatives at the minimum.
void set_parameter_errors(const MatrixXd& jacobian, double min_variance, Solution& solution) {
  const SymmetricEigen eigen = eigen_of(normal_of(jacobian));
  const Eigen::VectorXd& squares = eigen.values;
  const double infinity = std::numeric_limits<double>::infinity();
  solution.condition = squares[0] > 0.0 ? std::sqrt(squares[squares.size() - 1] / squares[0]) : infinity;
  solution.weakest = eigen.vectors.col(0);
  const Eigen::Index freedom = jacobian.rows() - jacobian.cols();
  const double scatter = freedom > 0 ? solution.residuals.squaredNorm() / static_cast<double>(freedom) : 0.0;
  const double variance = std::max(scatter, min_variance);
  solution.covariance = (variance * squares.cwiseInverse()).asDiagonal();
  change_basis(solution.covariance, eigen.vectors);
}

}  // namespace

Solution minimise(const Model& model, Eigen::VectorXd start, double min_variance) {
  constexpr int max_steps = 200;
  constexpr double convergence_tolerance = 1e-13;
  constexpr double max_damping = 1e12;
  Solution solution{.parameters = std::move(start)};
  Linearisation here = model(solution.parameters);
  double damping = 1e-3;
  for (int step = 0; step < max_steps && damping < max_damping; ++step) {
    MatrixXd normal = normal_of(here.jacobian);
    const double min_diagonal = 1e-12 * normal.diagonal().maxCoeff() + std::numeric_limits<double>::min();
    normal.diagonal() += damping * normal.diagonal().cwiseMax(min_diagonal);
    const Eigen::VectorXd change = solve_symmetric(normal, -here.jacobian.transpose() * here.residuals);
    Linearisation there = model(solution.parameters + change);
    // Written so that a NaN is no improvement.
    if (there.residuals.squaredNorm() <= here.residuals.squaredNorm()) {
      solution.parameters += change;
      here = std::move(there);
      damping *= 0.1;
    } else {
      damping *= 10.0;
    }
    if (change.norm() <= convergence_tolerance * (1.0 + solution.parameters.norm())) break;
  }
  solution.residuals = std::move(here.residuals);
  set_parameter_errors(here.jacobian, min_variance, solution);
  return solution;
}

void transform(Solution& solution, const MatrixXd& change) {
  solution.parameters = product(change, solution.parameters);
  change_basis(solution.covariance, change);
}

SymmetricEigen eigen_of(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd solve_symmetric(const MatrixXd& symmetric, const Eigen::VectorXd& right) {
  return symmetric.ldlt().solve(right);
}

Model differentiated(std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals, double step) {
  return [residuals = std::move(residuals), step](const Eigen::VectorXd& parameters) {
    Linearisation found{.residuals = residuals(parameters), .jacobian = {}};
    found.jacobian.resize(found.residuals.size(), parameters.size());
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(parameters.size(), i);
      found.jacobian.col(i) =
          (residuals(parameters + step * unit) - residuals(parameters - step * unit)) / (2.0 * step);
    }
    return found;
  };
}

}  // namespace sonopose::calibration::fit::detail
