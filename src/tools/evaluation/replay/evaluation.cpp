#include "evaluation/replay/evaluation.hpp"

#include "evaluation/score/comparison.hpp"
#include <sonopose/estimation/aiding/fix_refusals.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::evaluation {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Errors of all poses, scored or not, in ascending time.
struct ErrorTrack {
  std::vector<TimeNs> times_ns;
  std::vector<double> errors_m;
};

/// Seconds from `from_ns` to the end of the last window before `to_ns` whose error is too large.
double settled_after_s(const ErrorTrack& track, TimeNs from_ns, TimeNs to_ns) {
  const auto first = std::lower_bound(track.times_ns.begin(), track.times_ns.end(), from_ns);
  auto begin = static_cast<std::size_t>(first - track.times_ns.begin());
  double squares = 0.0;
  double settled_s = never;
  std::size_t end = begin;
  for (; end < track.times_ns.size() && track.times_ns[end] < to_ns; ++end) {
    squares += track.errors_m[end] * track.errors_m[end];
    while (seconds_between(track.times_ns[begin], track.times_ns[end]) > recovery_window_s) {
      squares -= track.errors_m[begin] * track.errors_m[begin];
      ++begin;
    }
    const double since_s = seconds_between(from_ns, track.times_ns[end]);
    if (since_s < recovery_window_s) continue;
    const bool bad = squares > recovered_m * recovered_m * static_cast<double>(end - begin + 1);
    if (bad) {
      settled_s = never;
    } else if (settled_s == never) {
      settled_s = since_s;
    }
  }
  return settled_s;
}

/// Measures the displacement of the pose during one outage, from the start of stale mode.
class DriftMonitor {
public:
  DriftMonitor(const sim::Outage& outage, TimeNs start_ns)
      : begin_ns_(start_ns + to_ns(outage.begin_s)), end_ns_(begin_ns_ + to_ns(outage.duration_s)) {}

  void add(const FusedPose& pose) {
    if (pose.time_ns < begin_ns_ || pose.time_ns > end_ns_ || (pose.status & status_stale) == 0) return;
    if (!began_) {
      began_ = true;
      from_world_m_ = pose.position_world_m;
      speed_mps_ = pose.velocity_world_mps.norm();
    }
    drift_m_ = std::max(drift_m_, (pose.position_world_m - from_world_m_).norm());
  }

  [[nodiscard]] double drift_m() const { return drift_m_; }
  [[nodiscard]] double speed_mps() const { return speed_mps_; }

private:
  TimeNs begin_ns_;
  TimeNs end_ns_;
  bool began_ = false;
  Vector3d from_world_m_ = Vector3d::Zero();
  double speed_mps_ = 0.0;
  double drift_m_ = 0.0;
};

ClearErrors clear_errors(const Score& score, const std::vector<sim::Outage>& gaps, TimeNs start_ns) {
  const auto in_gap = [&](double time_s) {
    return std::any_of(gaps.begin(), gaps.end(), [&](const sim::Outage& gap) {
      return time_s >= gap.begin_s && time_s < gap.begin_s + gap.duration_s + first_fixes_s;
    });
  };
  ClearErrors clear;
  std::vector<double> errors_m;
  double lost_s = 0;
  for (std::size_t i = 0; i < score.errors_m.size(); ++i) {
    const bool is_clear = !in_gap(seconds_between(start_ns, score.times_ns[i]));
    if (is_clear) errors_m.push_back(score.errors_m[i]);
    if (!(score.errors_m[i] > lost_m)) {
      lost_s = 0;
    } else if (is_clear && i > 0) {
      lost_s += seconds_between(score.times_ns[i - 1], score.times_ns[i]);
    }
    clear.lost_s = std::max(clear.lost_s, lost_s);
  }
  clear.rmse_m = error_summary_of(std::move(errors_m)).rmse;
  return clear;
}

/// Collects the poses and fixes of one case.
class CaseRun {
public:
  CaseRun(const Case& test_case, const settings::Settings& settings)
      : start_ns_(available_at_ns(test_case.events.front())),
        comparison_(test_case.truth, start_ns_ + to_ns(test_case.score_after_s)),
        whole_(test_case.truth, start_ns_),
        prediction_(start_ns_ + to_ns(test_case.score_after_s), settings, test_case.wheel_speeds) {
    for (const sim::Outage& outage : test_case.outages) drifts_.emplace_back(outage, start_ns_);
  }

  /// Takes an event before the estimator does.
  void add(const Event& event, const estimation::AnyEstimator& estimator) {
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) comparison_.add(*fix);
    prediction_.add(event, estimator);
  }

  void add(const estimation::EventResult& result) {
    prediction_.add(result);
    if (const auto* pose = std::get_if<FusedPose>(&result)) add(*pose);
  }

  void finish(const Case& test_case, const settings::Settings& settings, CaseResult& result) const {
    result.fused = comparison_.fused();
    result.clear = clear_errors(result.fused, test_case.without_good_fixes, start_ns_);
    result.last_fix_m = comparison_.last_fix_m();
    result.extrapolated_m = comparison_.extrapolated_m();
    result.prediction = prediction_.score();
    const Score whole = whole_.score();
    const ErrorTrack track{whole.times_ns, whole.errors_m};
    for (std::size_t i = 0; i < test_case.outages.size(); ++i) {
      const sim::Outage& outage = test_case.outages[i];
      const TimeNs end_ns = start_ns_ + to_ns(outage.begin_s + outage.duration_s);
      const bool last = i + 1 == test_case.outages.size();
      const TimeNs next_ns =
          last ? std::numeric_limits<TimeNs>::max() : start_ns_ + to_ns(test_case.outages[i + 1].begin_s);
      result.outages.push_back({outage.duration_s, settled_after_s(track, end_ns, next_ns),
                                drifts_[i].drift_m(), allowed_m(drifts_[i], outage, settings.outage)});
    }
    for (const sim::Relocation& relocation : test_case.relocations) {
      result.relocations.push_back(
          {relocation.by_world_m.norm(),
           settled_after_s(track, start_ns_ + to_ns(relocation.at_s), std::numeric_limits<TimeNs>::max())});
    }
  }

private:
  void add(const FusedPose& pose) {
    comparison_.add(pose);
    whole_.add(pose);
    for (DriftMonitor& drift : drifts_) drift.add(pose);
  }

  /// ∫ v·exp(−rate·t) dt over the part of the outage in stale mode.
  static double allowed_m(const DriftMonitor& drift, const sim::Outage& outage,
                          const settings::OutageSettings& settings) {
    const double stale_s = std::max(0.0, outage.duration_s - settings.stale_after_s);
    if (settings.velocity_decay_rate_hz <= 0.0) return drift.speed_mps() * stale_s;
    return drift.speed_mps() * -std::expm1(-settings.velocity_decay_rate_hz * stale_s) /
           settings.velocity_decay_rate_hz;
  }

  TimeNs start_ns_;
  Comparison comparison_;
  Scorer whole_;
  PredictionErrors prediction_;
  std::vector<DriftMonitor> drifts_;
};

/// Returns the middle value; the upper of the two for an even count. NaN counts as infinity.
double median(std::vector<double> values) {
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Value>
std::vector<double> each(const std::vector<CaseResult>& runs, const Value& value) {
  std::vector<double> values;
  for (const CaseResult& run : runs) values.push_back(value(run));
  return values;
}

/// Returns the median of the runs that know the value; NaN if none does.
template <class Value>
double median_known(const std::vector<CaseResult>& runs, const Value& value) {
  std::vector<double> values = each(runs, [&](const CaseResult& run) { return value(run.prediction); });
  std::erase_if(values, [](double known) { return std::isnan(known); });
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : median(std::move(values));
}

PredictionSummary prediction_of(const std::vector<CaseResult>& runs) {
  using Score = const PredictionScore&;
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  return {.fixes = median_known(runs, [](Score run) { return static_cast<double>(run.fixes.size()); }),
          .rms_m = median_known(runs, [](Score run) { return run.distance_m.rmse; }),
          .p50_m = median_known(runs, [](Score run) { return run.distance_p50_m; }),
          .p95_m = median_known(runs, [](Score run) { return run.distance_m.p95; }),
          .along_mean_m = median_known(runs, [](Score run) { return run.along_m.mean; }),
          .left_mean_m = median_known(runs, [](Score run) { return run.left_m.mean; }),
          .up_mean_m = median_known(runs, [](Score run) { return run.up_m.mean; }),
          .lag_one = median_known(runs, [](Score run) { return run.lag_one; }),
          .innovations =
              median_known(runs, [](Score run) { return run.innovations ? run.innovations->mean : unknown; }),
          .gated_share = median_known(runs, [](Score run) { return run.gated_share; }),
          .heading_rms_rad = median_known(runs, [](Score run) { return run.heading_rad.error.rms; }),
          .wheel_speed_rms_mps = median_known(runs, [](Score run) { return run.wheel_speed_mps.error.rms; })};
}

void update_max(std::optional<double>& max, double value) {
  max = std::max(max.value_or(value), value);
}

}  // namespace

CaseResult evaluate(const Case& test_case, const settings::Settings& settings) {
  CaseResult result;
  result.name = test_case.name;
  result.engine = settings::to_text(settings::get(settings, "fusion.engine"));
  result.has_truth = std::any_of(test_case.truth.begin(), test_case.truth.end(),
                                 [](const TruthSample& truth) { return truth.position_world_m.allFinite(); });
  estimation::AnyEstimator estimator(settings);
  CaseRun run(test_case, settings);
  estimation::aiding::RefusedFixes refusals;
  for (const Event& event : test_case.events) {
    run.add(event, estimator);
    const auto& admission = estimator.settings().admission;
    if (const auto* imu = std::get_if<ImuSample>(&event)) refusals.on(*imu, admission);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) refusals.on(*fix, admission);
    const auto output = estimation::process(estimator, event);
    if (const auto* report = std::get_if<FixReport>(&output)) refusals.on(*report);
    run.add(output);
  }
  result.fixes_used = estimator.counters().fixes_used;
  result.fixes_rejected = estimator.counters().fixes_rejected;
  if (result.fixes_used == 0) {
    result.fix_fault = result.fixes_rejected == 0
                           ? "has no fix"
                           : fmt::format("no fix was used, {} rejected: {}",
                                         text::count_text(result.fixes_rejected, "fix was", "fixes were"),
                                         refusals.reason());
  }
  run.finish(test_case, estimator.settings(), result);
  if (result.has_truth && result.fused.poses == 0 && result.fused.poses_without_truth > 0) {
    result.has_truth = false;
    result.truth_fault = fmt::format("no true position at the time of any of its {}",
                                     text::count_text(result.fused.poses_without_truth, "pose"));
  }
  return result;
}

std::vector<CaseResult> evaluate_all(const std::vector<Case>& runs, const settings::Settings& settings) {
  std::vector<CaseResult> results;
  results.reserve(runs.size());
  for (const Case& run : runs) results.push_back(evaluate(run, settings));
  return results;
}

Summary summarise(const std::vector<CaseResult>& runs) {
  Summary summary;
  summary.name = runs.front().name;
  summary.engine = runs.front().engine;
  summary.runs = runs.size();
  summary.has_truth = runs.front().has_truth;
  summary.truth_fault = runs.front().truth_fault;
  summary.prediction = prediction_of(runs);
  for (const CaseResult& run : runs) summary.predictions.push_back(run.prediction);
  if (!summary.has_truth) return summary;
  const auto position = [](const CaseResult& run) {
    return std::isnan(run.fused.position_m.rmse) ? std::numeric_limits<double>::infinity()
                                                 : run.fused.position_m.rmse;
  };
  const std::vector<double> errors_m = each(runs, position);
  summary.position_rmse_m = median(errors_m);
  summary.worst_rmse_m = *std::max_element(errors_m.begin(), errors_m.end());
  summary.clear_rmse_m = median(each(runs, [](const CaseResult& run) { return run.clear.rmse_m; }));
  const std::vector<double> lost_s = each(runs, [](const CaseResult& run) { return run.clear.lost_s; });
  summary.lost_s = *std::max_element(lost_s.begin(), lost_s.end());
  summary.position_p95_m = median(each(runs, [](const CaseResult& run) { return run.fused.position_m.p95; }));
  summary.yaw_rmse_deg = median(each(runs, [](const CaseResult& run) { return run.fused.yaw_rmse_deg; }));
  summary.tilt_rmse_deg = median(each(runs, [](const CaseResult& run) { return run.fused.tilt_rmse_deg; }));
  summary.velocity_rmse_mps =
      median(each(runs, [](const CaseResult& run) { return run.fused.velocity_rmse_mps; }));
  summary.last_fix_rmse_m = median(each(runs, [](const CaseResult& run) { return run.last_fix_m.rmse; }));
  summary.extrapolated_rmse_m =
      median(each(runs, [](const CaseResult& run) { return run.extrapolated_m.rmse; }));
  for (const CaseResult& run : runs) {
    for (const OutageResult& outage : run.outages) {
      update_max(summary.slowest_recovery_s, outage.recovery_s);
      if (outage.drift_allowed_m > 0.0) {
        update_max(summary.worst_drift_share, outage.drift_m / outage.drift_allowed_m);
      }
    }
    for (const RelocationResult& relocation : run.relocations) {
      update_max(summary.slowest_recovery_s, relocation.settled_s);
    }
  }
  return summary;
}

std::optional<double> cost_of(const std::vector<CaseResult>& runs, const std::vector<CaseResult>& reference) {
  std::vector<double> costs_m;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].fix_fault.empty()) return std::nullopt;
    const double cost_m = reference[i].has_truth
                              ? runs[i].fused.position_m.rmse
                              : evaluation::cost_of(runs[i].prediction, reference[i].prediction);
    if (!reference[i].has_truth && std::isnan(cost_m)) return std::nullopt;
    costs_m.push_back(std::isnan(cost_m) ? never : cost_m);
  }
  return std::sqrt(median(costs_m) * *std::max_element(costs_m.begin(), costs_m.end()));
}

CostFunction::CostFunction(std::vector<std::vector<Case>> cases, const settings::Settings& reference) {
  for (auto& runs : cases) {
    std::vector<CaseResult> results = evaluate_all(runs, reference);
    if (std::isfinite(cost_of(results, results).value_or(never))) {
      rows_.push_back({std::move(runs), std::move(results)});
    } else {
      const std::string& fault = results.front().fix_fault;
      left_out_.push_back(fmt::format(
          "{}: {}", runs.front().name,
          fault.empty() ? fmt::format("nothing to score after {:g} s", runs.front().score_after_s) : fault));
    }
  }
}

double CostFunction::operator()(const settings::Settings& settings) const {
  double logarithms = 0.0;
  for (const Row& row : rows_) {
    logarithms += std::log(cost_of(evaluate_all(row.runs, settings), row.reference).value_or(never));
  }
  return std::exp(logarithms / static_cast<double>(rows_.size()));
}

bool CostFunction::has_truth_of_all() const {
  return std::all_of(rows_.begin(), rows_.end(),
                     [](const Row& row) { return row.reference.front().has_truth; });
}

}  // namespace sonopose::evaluation
