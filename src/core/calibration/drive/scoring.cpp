#include "calibration/drive/scoring.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace sonopose::calibration::drive::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Resolution of a beacon: a coordinate that never changes has no smaller noise.
constexpr double min_fix_noise_m = 1e-3;

/// Step of the central differences.
double step_of(Index unknown) {
  switch (unknown) {
    case at_mount:
      return 2e-3;
    case at_delay:
      return 1e-3;
    case at_fix_horizontal:
    case at_fix_vertical:
    case at_heading:
    case at_accel:
    case at_gyro:
      return 0.02;
    default:
      return 2e-3;  // a yaw
  }
}

/// Largest change of an unknown in a step.
double max_step_of(Index unknown) {
  switch (unknown) {
    case at_delay:
      return 0.02;
    case at_fix_horizontal:
    case at_fix_vertical:
    case at_heading:
    case at_accel:
    case at_gyro:
      return 0.7;
    default:
      return 0.15;  // an angle
  }
}

/// Derivative of −2 log L, and half of the expected second derivative: the information.
struct NormalEquations {
  VectorXd gradient;
  MatrixXd information;
  std::vector<MatrixXd> lever_arm_slopes;  ///< one per log: 3 rows, a column per unknown
};

struct Slope {
  Vector3d value;
  Eigen::Matrix3d covariance;
};

/// Adds one residual, whose derivatives by the unknowns are `slopes`.
template <int rows>
void add(NormalEquations& normal, const Residual& residual, const std::vector<Slope>& slopes) {
  using Square = Eigen::Matrix<double, rows, rows>;
  using Column = Eigen::Matrix<double, rows, 1>;
  const Square inverse = residual.covariance.topLeftCorner<rows, rows>().inverse();
  const Column weighted = inverse * residual.value.head<rows>();
  const auto count = static_cast<Index>(slopes.size());
  std::vector<Square> relative(slopes.size());
  for (Index i = 0; i < count; ++i) {
    const Slope& slope = slopes[static_cast<std::size_t>(i)];
    const Square change = slope.covariance.topLeftCorner<rows, rows>();
    relative[static_cast<std::size_t>(i)] = inverse * change;
    normal.gradient(i) += 2.0 * weighted.dot(slope.value.head<rows>()) - weighted.dot(change * weighted) +
                          relative[static_cast<std::size_t>(i)].trace();
    const Column whitened = inverse * slope.value.head<rows>();
    for (Index j = 0; j <= i; ++j) {
      const Slope& other = slopes[static_cast<std::size_t>(j)];
      const double information =
          whitened.dot(other.value.head<rows>()) +
          0.5 * (relative[static_cast<std::size_t>(i)] * relative[static_cast<std::size_t>(j)]).trace();
      normal.information(i, j) += information;
      if (i != j) normal.information(j, i) += information;
    }
  }
}

NormalEquations normal_equations(const Problem& problem, const VectorXd& unknowns,
                                 const std::vector<Pass>& centre) {
  const Index count = problem.size();
  NormalEquations normal{VectorXd::Zero(count), MatrixXd::Zero(count, count), {}};
  std::vector<std::vector<Pass>> above;
  std::vector<std::vector<Pass>> below;
  for (Index i = 0; i < count; ++i) {
    VectorXd moved = unknowns;
    moved(i) = unknowns(i) + step_of(i);
    above.push_back(problem.passes_after_change(centre, moved, i));
    moved(i) = unknowns(i) - step_of(i);
    below.push_back(problem.passes_after_change(centre, moved, i));
  }
  std::vector<Slope> slopes(static_cast<std::size_t>(count));
  for (std::size_t log = 0; log < centre.size(); ++log) {
    for (std::size_t k = 0; k < centre[log].residuals.size(); ++k) {
      const Residual& residual = centre[log].residuals[k];
      for (std::size_t i = 0; i < slopes.size(); ++i) {
        const Residual& up = above[i][log].residuals[k];
        const Residual& down = below[i][log].residuals[k];
        const double span = 2.0 * step_of(static_cast<Index>(i));
        slopes[i] = {(up.value - down.value) / span, (up.covariance - down.covariance) / span};
      }
      if (residual.is_heading) {
        add<1>(normal, residual, slopes);
      } else {
        add<3>(normal, residual, slopes);
      }
    }
    MatrixXd lever(3, count);
    for (Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      lever.col(i) =
          (above[at][log].lever_arm.value_m - below[at][log].lever_arm.value_m) / (2.0 * step_of(i));
    }
    normal.lever_arm_slopes.push_back(lever);
  }
  for (Index i = 0; i < count; ++i) {
    const Eigen::Vector2d prior = Problem::prior_of(i);
    normal.gradient(i) += 2.0 * (unknowns(i) - prior(0)) / (prior(1) * prior(1));
    normal.information(i, i) += 1.0 / (prior(1) * prior(1));
  }
  return normal;
}

/// Lever arms at the end of each pass, including the uncertainty of the unknowns.
std::vector<LeverArm> lever_arms_of(const Fit& fit, const NormalEquations& normal) {
  std::vector<LeverArm> arms;
  for (std::size_t log = 0; log < fit.passes.size(); ++log) {
    arms.push_back(fit.passes[log].lever_arm);
    const MatrixXd& slopes = normal.lever_arm_slopes[log];
    arms.back().covariance_m2 += slopes * fit.covariance * slopes.transpose();
  }
  return arms;
}

}  // namespace

double fix_noise_m(double logarithm) {
  return std::hypot(std::exp(logarithm), min_fix_noise_m);
}

Problem::Problem(const std::vector<Measurements>& logs)
    : logs_(logs), lever_arms_m_(logs.size(), Vector3d::Zero()) {
  for (const Measurements& log : logs) {
    at_start_yaw_.push_back(log.has_heading() ? -1 : size_++);
  }
}

VectorXd Problem::vector_of(const Parameters& parameters, const std::vector<double>& start_yaw_rad) const {
  VectorXd unknowns(size_);
  unknowns.head<common_unknowns>() << parameters.mount_rad, parameters.delay_s,
      std::log(parameters.fix_horizontal_m), std::log(parameters.fix_vertical_m),
      std::log(parameters.heading_rad), std::log(parameters.accel_mps2_rthz),
      std::log(parameters.gyro_radps_rthz);
  for (std::size_t log = 0; log < at_start_yaw_.size(); ++log) {
    if (at_start_yaw_[log] >= 0) unknowns(at_start_yaw_[log]) = start_yaw_rad[log];
  }
  return unknowns;
}

Parameters Problem::parameters_of(const VectorXd& unknowns, std::size_t log) const {
  const Index at_yaw = at_start_yaw_[log];
  return {.mount_rad = unknowns(at_mount),
          .start_yaw_rad = at_yaw < 0 ? 0.0 : unknowns(at_yaw),
          .delay_s = unknowns(at_delay),
          .fix_horizontal_m = fix_noise_m(unknowns(at_fix_horizontal)),
          .fix_vertical_m = fix_noise_m(unknowns(at_fix_vertical)),
          .heading_rad = std::exp(unknowns(at_heading)),
          .accel_mps2_rthz = std::exp(unknowns(at_accel)),
          .gyro_radps_rthz = std::exp(unknowns(at_gyro))};
}

Pass Problem::pass(const VectorXd& unknowns, std::size_t log) const {
  return forward_pass(logs_[log], parameters_of(unknowns, log), {.lever_arm_m = lever_arms_m_[log]});
}

std::vector<Pass> Problem::passes(const VectorXd& unknowns) const {
  std::vector<Pass> all;
  for (std::size_t log = 0; log < logs_.size(); ++log) all.push_back(pass(unknowns, log));
  return all;
}

std::vector<Pass> Problem::passes_after_change(const std::vector<Pass>& before, const VectorXd& unknowns,
                                               Index changed) const {
  if (changed < common_unknowns) return passes(unknowns);
  std::vector<Pass> all = before;
  for (std::size_t log = 0; log < logs_.size(); ++log) {
    if (at_start_yaw_[log] == changed) all[log] = pass(unknowns, log);
  }
  return all;
}

double Problem::minus_2_log_l(const VectorXd& unknowns, const std::vector<Pass>& passes) const {
  double sum = 0;
  for (const Pass& pass : passes) sum += pass.minus_2_log_l;
  for (Index i = 0; i < size_; ++i) {
    const Eigen::Vector2d prior = prior_of(i);
    sum += std::pow((unknowns(i) - prior(0)) / prior(1), 2);
  }
  return sum;
}

void Problem::start_lever_arms_at(const std::vector<LeverArm>& lever_arms) {
  // A lever arm known less well stays at zero; otherwise it would wander from step to step.
  constexpr double known_m = 0.02;
  for (std::size_t log = 0; log < lever_arms.size(); ++log) {
    for (Index i = 0; i < 3; ++i) {
      const bool is_known = lever_arms[log].covariance_m2(i, i) < known_m * known_m;
      lever_arms_m_[log](i) = is_known ? lever_arms[log].value_m(i) : 0.0;
    }
  }
}

Eigen::Vector2d Problem::prior_of(Index unknown) {
  // Wide priors: they only keep a matrix invertible if the log says nothing.
  switch (unknown) {
    case at_delay:
      return {0.0, 0.1};
    case at_fix_horizontal:
    case at_fix_vertical:
      return {std::log(0.03), 3.0};
    case at_heading:
      return {std::log(0.02), 3.0};
    case at_accel:
      return {std::log(0.003), 2.0};
    case at_gyro:
      return {std::log(2e-4), 2.0};
    default:
      return {0.0, 10.0};  // an angle
  }
}

Fit maximise(Problem& problem, const VectorXd& start, const StepObserver& observer) {
  constexpr int max_steps = 25;
  constexpr double convergence_limit = 0.01;  // −2 log L, of which 1 is a standard deviation
  Fit fit;
  fit.unknowns = start;
  double damping = 1e-3;
  for (int step = 0; step < max_steps && !fit.converged; ++step) {
    if (observer) observer(step);
    problem.start_lever_arms_at(fit.lever_arms);
    fit.passes = problem.passes(fit.unknowns);
    fit.minus_2_log_l = problem.minus_2_log_l(fit.unknowns, fit.passes);
    const NormalEquations normal = normal_equations(problem, fit.unknowns, fit.passes);
    fit.covariance = normal.information.ldlt().solve(MatrixXd::Identity(problem.size(), problem.size()));
    fit.lever_arms = lever_arms_of(fit, normal);
    for (int attempt = 0;; ++attempt) {
      MatrixXd damped = normal.information;
      damped.diagonal() *= 1.0 + damping;
      VectorXd change = -0.5 * damped.ldlt().solve(normal.gradient);
      double scale = 1.0;
      for (Index i = 0; i < change.size(); ++i) {
        scale = std::min(scale, max_step_of(i) / std::max(1e-12, std::abs(change(i))));
      }
      const VectorXd candidate = fit.unknowns + scale * change;
      auto passes = problem.passes(candidate);
      const double minus_2_log_l = problem.minus_2_log_l(candidate, passes);
      if (minus_2_log_l < fit.minus_2_log_l) {
        fit.converged = fit.minus_2_log_l - minus_2_log_l < convergence_limit;
        fit.unknowns = candidate;
        fit.passes = std::move(passes);
        fit.minus_2_log_l = minus_2_log_l;
        damping = std::max(1e-6, damping * 0.2);
        break;
      }
      damping = std::max(damping, 1e-4) * 8.0;
      if (attempt == 8) {
        fit.converged = true;  // no step improves the fit
        break;
      }
    }
  }
  return fit;
}

}  // namespace sonopose::calibration::drive::detail
