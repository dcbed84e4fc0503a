#pragma once
/// \file
/// Parameters that make the measurements of several logs most probable, by Fisher scoring: Gauss–Newton steps
/// with the information of the innovations. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// Indices of the unknowns in a vector. Noises are logarithms. The start yaws of pieces without headings
/// follow as further unknowns.
enum Unknown : int {
  at_mount,
  at_delay,
  at_fix_horizontal,
  at_fix_vertical,
  at_heading,
  at_accel,
  at_gyro,
  common_unknowns
};

/// Standard deviation of a fix from an unknown, its logarithm: never below the resolution of a beacon.
double fix_noise_m(double logarithm);

/// Pieces of the logs of one installation, with common mount, delay and noise.
class Problem {
public:
  /// Keeps a reference to `logs`.
  explicit Problem(const std::vector<Measurements>& logs);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Eigen::VectorXd vector_of(const Parameters& parameters,
                                          const std::vector<double>& start_yaw_rad) const;
  [[nodiscard]] Parameters parameters_of(const Eigen::VectorXd& unknowns, std::size_t log) const;

  /// Makes one pass over each log.
  [[nodiscard]] std::vector<Pass> passes(const Eigen::VectorXd& unknowns) const;

  /// Makes the passes again after a change of one unknown; a start yaw changes only the pass of its log.
  [[nodiscard]] std::vector<Pass> passes_after_change(const std::vector<Pass>& before,
                                                      const Eigen::VectorXd& unknowns,
                                                      Eigen::Index changed) const;

  /// −2 log L of these passes, including the priors of the unknowns.
  [[nodiscard]] double minus_2_log_l(const Eigen::VectorXd& unknowns, const std::vector<Pass>& passes) const;

  /// Sets where the estimates of the lever arms start in the next passes.
  void start_lever_arms_at(const std::vector<LeverArm>& lever_arms);

  /// Mean and standard deviation of an unknown before any measurement.
  [[nodiscard]] static Eigen::Vector2d prior_of(Eigen::Index unknown);

  [[nodiscard]] const std::vector<Measurements>& logs() const { return logs_; }

private:
  [[nodiscard]] Pass pass(const Eigen::VectorXd& unknowns, std::size_t log) const;

  const std::vector<Measurements>& logs_;
  std::vector<Vector3d> lever_arms_m_;
  std::vector<Eigen::Index> at_start_yaw_;  ///< per log; −1 if it has headings
  Eigen::Index size_ = common_unknowns;
};

struct Fit {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd covariance;        ///< covariance of the unknowns
  std::vector<Pass> passes;          ///< passes at the solution
  std::vector<LeverArm> lever_arms;  ///< per log, with the uncertainty of the unknowns
  double minus_2_log_l = 0;
  bool converged = false;
};

/// Called before each step with the number of steps so far.
using StepObserver = std::function<void(int step)>;

/// Finds the maximum near `start`.
Fit maximise(Problem& problem, const Eigen::VectorXd& start, const StepObserver& observer = {});

}  // namespace sonopose::calibration::drive::detail
