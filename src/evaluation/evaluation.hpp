#pragma once
/// \file
/// Cases with a known truth, and how the fusion does on each of them: the simulator's scenarios, and
/// recordings with motion capture.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>
#include "evaluation/score.hpp"
#include "sim/scenario.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Events with the truth behind them.
struct Case {
  std::string name;
  std::vector<Event> events;
  std::vector<TruthSample> truth;
  double score_after_s = 6;          ///< after the first event
  std::vector<sim::Outage> outages;  ///< what is watched besides the error as a whole
  std::vector<sim::Relocation> relocations;
};

/// One seed's run of a scenario.
Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed);

/// A sensor-log folder with truth. Throws files::IoError; also where it has no truth.
Case recorded_case(const std::filesystem::path& folder);

/// Every folder at or below `folder` that holds IMU, fixes and truth, in alphabetical order. Throws
/// files::IoError where it is no folder.
std::vector<std::filesystem::path> recordings_with_truth(const std::filesystem::path& folder);

/// What an outage brought.
struct OutageResult {
  double duration_s;
  /// From its end until the error's RMS over half a second stays below `recovered_m`; infinite: never.
  double recovery_s;
  double drift_m;          ///< farthest way of the pose after stale mode began
  double drift_allowed_m;  ///< speed at the beginning of stale mode / setting 10, as far as that decay goes
};

/// What a relocation brought.
struct RelocationResult {
  double distance_m;
  double settled_s;  ///< until the error's RMS over half a second stays below `recovered_m`
};

inline constexpr double recovered_m = 0.06;
inline constexpr double recovery_window_s = 0.5;

/// One case under one set of settings.
struct CaseResult {
  std::string name;
  Score fused;
  ErrorSummary last_fix_m;      ///< the same moments, by the latest fix
  ErrorSummary extrapolated_m;  ///< and by the fix carried on at its velocity
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::vector<OutageResult> outages;
  std::vector<RelocationResult> relocations;
};

CaseResult evaluate(const Case& test_case, const settings::Settings& settings);

/// Several seeds of one case together.
struct Summary {
  std::string name;
  std::size_t runs = 0;
  double position_rmse_m = 0;  ///< median over the runs, as all that follows
  double worst_rmse_m = 0;     ///< of the worst run
  double position_p95_m = 0;
  double yaw_rmse_deg = 0;
  double tilt_rmse_deg = 0;
  double velocity_rmse_mps = 0;
  double last_fix_rmse_m = 0;
  double extrapolated_rmse_m = 0;
  std::optional<double> slowest_recovery_s;  ///< of any outage or relocation in any run
  std::optional<double> worst_drift_share;   ///< of what the stale rule allows, in any outage
};

/// Results of one case's runs, which must not be empty. A run whose error is not a number counts as the
/// worst.
Summary summarise(const std::vector<CaseResult>& runs);

/// One number for all: the geometric mean over the cases of √(median · worst) of their runs' RMS errors (m),
/// so that each case counts for the same share, and one bad run for as much as the usual one.
double cost_of(const std::vector<std::vector<Case>>& cases, const settings::Settings& settings);

/// Summaries as an aligned table with a header.
std::string table_of(const std::vector<Summary>& summaries);

/// Summaries as a JSON array.
std::string json_of(const std::vector<Summary>& summaries);

}  // namespace sonopose::evaluation
