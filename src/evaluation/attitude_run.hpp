#pragma once
/// \file
/// An attitude filter over a log, and its score as attitude benchmarks give it.

#include <sonopose/settings/settings.hpp>
#include "recording/attitude_log.hpp"
#include "evaluation/score.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// One filter over one log.
struct AttitudeResult {
  std::string name;
  std::size_t samples = 0;          ///< given to the filter
  std::size_t rejected = 0;         ///< of them no measurements
  std::size_t scored = 0;           ///< in the movements, with a known truth; 0: the errors are NaN
  double total_rmse_deg = 0;        ///< 2·acos |d_w| of d = q_estimate ⊗ q_truth*
  double heading_rmse_deg = 0;      ///< 2·atan |d_z/d_w|
  double inclination_rmse_deg = 0;  ///< 2·acos √(d_w² + d_z²)
};

/// Runs the filter that `settings` name over the calibrated samples, from the first to the last; `tell` gets
/// each orientation.
AttitudeResult run_attitude(const std::string& name, const recording::AttitudeLog& log,
                            const settings::Settings& settings,
                            const std::function<void(TimeNs, const Quaterniond&)>& tell = {});

/// The unweighted mean of each error over those results that have been scored; its `scored` counts logs.
AttitudeResult mean_of(const std::vector<AttitudeResult>& results);

/// A table with a row for each log and, of several, their mean.
std::string attitude_text(const std::vector<AttitudeResult>& results);

/// The same as a JSON object.
std::string attitude_json(const std::vector<AttitudeResult>& results);

}  // namespace sonopose::evaluation
