#pragma once
/// \file
/// The parameters that make the measurements of several logs most probable, by Fisher's scoring: Gauss and
/// Newton's step with the information of the innovations. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// The places of the unknowns in a vector. The noises are logarithms. A log without headings has its yaw at
/// the start as a further unknown, after these.
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

/// The standard deviation of a fix for an unknown, its logarithm: never below the resolution of a beacon.
double fix_noise_m(double logarithm);

/// Logs of one installation: mount, delay and noise are common.
class Problem {
public:
  /// Keeps a reference.
  explicit Problem(const std::vector<Measurements>& logs);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Eigen::VectorXd vector_of(const Parameters& parameters,
                                          const std::vector<double>& start_yaw_rad) const;
  [[nodiscard]] Parameters parameters_of(const Eigen::VectorXd& unknowns, std::size_t log) const;

  /// One pass over each log.
  [[nodiscard]] std::vector<Pass> passes(const Eigen::VectorXd& unknowns) const;

  /// −2 log L of these passes, with what is known beforehand of the unknowns.
  [[nodiscard]] double minus_2_log_l(const Eigen::VectorXd& unknowns, const std::vector<Pass>& passes) const;

  /// Where the estimates of the lever arms start in the next passes.
  void start_lever_arms_at(const std::vector<LeverArm>& lever_arms);

  /// The mean and the standard deviation that an unknown has before any measurement.
  [[nodiscard]] static Eigen::Vector2d prior_of(Eigen::Index unknown);

  [[nodiscard]] const std::vector<Measurements>& logs() const { return logs_; }

private:
  const std::vector<Measurements>& logs_;
  std::vector<Vector3d> lever_arms_m_;
  std::vector<Eigen::Index> at_start_yaw_;  ///< per log; −1: it has headings
  Eigen::Index size_ = common_unknowns;
};

struct Fit {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd covariance;        ///< of the unknowns
  std::vector<Pass> passes;          ///< at the solution
  std::vector<LeverArm> lever_arms;  ///< per log, with the uncertainty of the unknowns
  double minus_2_log_l = 0;
  bool converged = false;
};

/// Called before each step with the number of steps so far.
using StepObserver = std::function<void(int step)>;

/// The maximum near `start`.
Fit maximise(Problem& problem, const Eigen::VectorXd& start, const StepObserver& observer = {});

}  // namespace sonopose::calibration::drive::detail
