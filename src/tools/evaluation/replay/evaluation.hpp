#pragma once
/// \file
/// Scores the fusion on cases, against known truth and by its prediction errors.

#include "evaluation/replay/cases.hpp"
#include "evaluation/score/prediction_errors.hpp"
#include "evaluation/score/score.hpp"
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

struct OutageResult {
  double duration_s;
  /// Time from its end until the RMS error over half a second stays below `recovered_m`; infinite: never.
  double recovery_s;
  double drift_m;          ///< largest displacement of the pose after stale mode began
  double drift_allowed_m;  ///< integral of the speed at the start of stale mode under the decay of item 10
};

struct RelocationResult {
  double distance_m;
  double settled_s;  ///< time until the RMS error over half a second stays below `recovered_m`
};

inline constexpr double recovered_m = 0.06;
inline constexpr double recovery_window_s = 0.5;

/// Errors while good fixes arrive: outside of gaps and wrong tracks, and of the time after each in which the
/// first two fixes arrive.
struct ClearErrors {
  double rmse_m = std::numeric_limits<double>::quiet_NaN();
  /// Longest time with an error above `lost_m`. A gap or wrong track does not count and does not end it.
  double lost_s = 0;
};

inline constexpr double first_fixes_s = 0.5;
inline constexpr double lost_m = 1.0;

/// The result of one case with one set of settings.
struct CaseResult {
  std::string name;
  std::string engine;         ///< value of fusion.engine
  std::string truth_fault{};  ///< fault of an unusable truth; empty if usable or absent
  std::string fix_fault{};    ///< reason why no fix was used; empty if one was
  bool has_truth = false;     ///< true position is known; otherwise `fused` and the next two errors are NaN
  Score fused;
  ClearErrors clear;
  ErrorSummary last_fix_m;      ///< error of the latest fix at the same times
  ErrorSummary extrapolated_m;  ///< error of the extrapolated fix at the same times
  PredictionScore prediction;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::vector<OutageResult> outages;
  std::vector<RelocationResult> relocations;
};

CaseResult evaluate(const Case& test_case, const settings::Settings& settings);

std::vector<CaseResult> evaluate_all(const std::vector<Case>& runs, const settings::Settings& settings);

/// Prediction errors over several runs: the median of each figure. NaN: unknown.
struct PredictionSummary {
  double fixes = 0;
  double rms_m = 0;
  double p50_m = 0;
  double p95_m = 0;
  double along_mean_m = 0;
  double left_mean_m = 0;
  double up_mean_m = 0;
  double lag_one = 0;
  double innovations = 0;  ///< mean squared normalised innovation per degree of freedom; 1 is expected
  double gated_share = 0;
  double heading_rms_rad = 0;
  double wheel_speed_rms_mps = 0;
};

/// The summary of several runs of one case.
struct Summary {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  std::string name;
  std::string engine;
  std::size_t runs = 0;
  std::string truth_fault{};         ///< truth fault of the first run
  bool has_truth = false;            ///< truth is known; otherwise the following errors are NaN
  double position_rmse_m = unknown;  ///< median over the runs, like the following values
  double worst_rmse_m = unknown;     ///< error of the worst run
  double clear_rmse_m = unknown;     ///< error while good fixes arrive
  double lost_s = 0;                 ///< time in the worst run
  double position_p95_m = unknown;
  double yaw_rmse_deg = unknown;
  double tilt_rmse_deg = unknown;
  double velocity_rmse_mps = unknown;
  double last_fix_rmse_m = unknown;
  double extrapolated_rmse_m = unknown;
  std::optional<double> slowest_recovery_s;  ///< slowest of all outages and relocations of all runs
  std::optional<double> worst_drift_share;   ///< drift / allowed drift, over all outages
  PredictionSummary prediction;
  std::vector<PredictionScore> predictions;  ///< scores of each run
};

/// Summarises the runs of one case; `runs` must not be empty. A run whose error is NaN counts as the worst.
Summary summarise(const std::vector<CaseResult>& runs);

/// Returns the cost of the runs of one case, m: √(median · worst) of their RMS errors, so that the worst run
/// counts as much as the median run. Without truth, uses their prediction errors at the fixes that
/// `reference`, the same runs with other settings, trusted. Empty if there are none.
std::optional<double> cost_of(const std::vector<CaseResult>& runs, const std::vector<CaseResult>& reference);

/// The cost of settings over several cases.
class CostFunction {
public:
  /// `reference`: the settings that select the fixes for cases without truth.
  CostFunction(std::vector<std::vector<Case>> cases, const settings::Settings& reference);

  /// The cases without cost, and the reasons.
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  /// Returns true if no prediction error counts.
  [[nodiscard]] bool has_truth_of_all() const;

  /// Returns the geometric mean over the cases, m: every case has the same weight.
  double operator()(const settings::Settings& settings) const;

private:
  struct Row {
    std::vector<Case> runs;
    std::vector<CaseResult> reference;
  };

  std::vector<Row> rows_;
  std::vector<std::string> left_out_;
};

}  // namespace sonopose::evaluation
