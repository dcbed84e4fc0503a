#pragma once
/// \file
/// Scores the fusion on cases with a known truth: the simulator's scenarios, and recordings with motion
/// capture.

#include "evaluation/score.hpp"
#include "sim/scenario.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Events and the corresponding truth.
struct Case {
  std::string name;
  std::vector<Event> events;
  std::vector<TruthSample> truth;
  double score_after_s = 6;          ///< after the first event
  std::vector<sim::Outage> outages;  ///< scored separately, in addition to the overall error
  std::vector<sim::Relocation> relocations;
};

/// One run of a scenario.
Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed);

/// A sensor-log folder with truth. Throws files::IoError, also if it has no truth.
Case recorded_case(const std::filesystem::path& folder);

/// Every folder at or below `folder` that contains IMU, fixes and truth, in alphabetical order. Throws
/// files::IoError if `folder` is not a folder.
std::vector<std::filesystem::path> recordings_with_truth(const std::filesystem::path& folder);

/// Effect of one outage.
struct OutageResult {
  double duration_s;
  /// Time from its end until the RMS error over half a second stays below `recovered_m`; infinite: never.
  double recovery_s;
  double drift_m;          ///< largest displacement of the pose after stale mode began
  double drift_allowed_m;  ///< integral of the speed at the start of stale mode under the decay of item 10
};

/// Effect of one relocation.
struct RelocationResult {
  double distance_m;
  double settled_s;  ///< until the RMS error over half a second stays below `recovered_m`
};

inline constexpr double recovered_m = 0.06;
inline constexpr double recovery_window_s = 0.5;

/// Result of one case with one set of settings.
struct CaseResult {
  std::string name;
  std::string engine;  ///< the value of fusion.engine
  Score fused;
  ErrorSummary last_fix_m;      ///< error of the latest fix at the same times
  ErrorSummary extrapolated_m;  ///< error of the extrapolated fix at the same times
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::vector<OutageResult> outages;
  std::vector<RelocationResult> relocations;
};

CaseResult evaluate(const Case& test_case, const settings::Settings& settings);

/// Summary over several runs of one case.
struct Summary {
  std::string name;
  std::string engine;
  std::size_t runs = 0;
  double position_rmse_m = 0;  ///< median over the runs, like the values that follow
  double worst_rmse_m = 0;     ///< of the worst run
  double position_p95_m = 0;
  double yaw_rmse_deg = 0;
  double tilt_rmse_deg = 0;
  double velocity_rmse_mps = 0;
  double last_fix_rmse_m = 0;
  double extrapolated_rmse_m = 0;
  std::optional<double> slowest_recovery_s;  ///< over all outages and relocations of all runs
  std::optional<double> worst_drift_share;   ///< drift / allowed drift, over all outages
};

/// Summarises the runs of one case; `runs` must not be empty. A run whose error is NaN counts as the worst.
Summary summarise(const std::vector<CaseResult>& runs);

/// Cost of the settings, m: the geometric mean over the cases of √(median · worst) of the runs' RMS errors.
/// Every case has the same weight, and the worst run counts as much as the median run.
double cost_of(const std::vector<std::vector<Case>>& cases, const settings::Settings& settings);

/// Summaries as an aligned table with a header.
std::string table_of(const std::vector<Summary>& summaries);

/// Summaries as a JSON array.
std::string json_of(const std::vector<Summary>& summaries);

}  // namespace sonopose::evaluation
