#pragma once
/// \file
/// Runs an attitude filter over a log and scores it like the public attitude benchmarks.

#include "evaluation/score/score.hpp"
#include "recording/attitude_log.hpp"
#include <sonopose/settings/settings.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// The score of one filter on one log.
struct AttitudeResult {
  std::string name;
  std::size_t samples = 0;          ///< samples given to the filter
  std::size_t rejected = 0;         ///< samples that the filter refused
  std::size_t scored = 0;           ///< samples within a movement and with known truth; 0: the errors are NaN
  double total_rmse_deg = 0;        ///< 2·acos |d_w| of d = q_estimate ⊗ q_truth*
  double heading_rmse_deg = 0;      ///< 2·atan |d_z/d_w|
  double inclination_rmse_deg = 0;  ///< 2·acos √(d_w² + d_z²)
};

/// Runs the filter selected by `settings` over all calibrated samples. Calls `on_orientation` after each.
AttitudeResult run_attitude(const std::string& name, const recording::AttitudeLog& log,
                            const settings::Settings& settings,
                            const std::function<void(TimeNs, const Quaterniond&)>& on_orientation = {});

/// Unweighted mean of each error over the scored results; its `scored` is the number of logs.
AttitudeResult mean_of(const std::vector<AttitudeResult>& results);

/// Writes a table with one row per log and, for several logs, their mean.
std::string attitude_text(const std::vector<AttitudeResult>& results);

/// Formats the results as a JSON object.
std::string attitude_json(const std::vector<AttitudeResult>& results);

}  // namespace sonopose::evaluation
