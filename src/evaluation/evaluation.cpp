#include "evaluation/evaluation.hpp"

#include "evaluation/comparison.hpp"
#include "recording/log_folder.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/any_estimator.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

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

/// Measures the displacement of the pose during one outage, from the time at which it became stale.
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

/// Collects the poses and fixes of one case.
class CaseRun {
public:
  explicit CaseRun(const Case& test_case)
      : start_ns_(available_at_ns(test_case.events.front())),
        comparison_(test_case.truth, start_ns_ + to_ns(test_case.score_after_s)),
        whole_(test_case.truth, start_ns_) {
    for (const sim::Outage& outage : test_case.outages) drifts_.emplace_back(outage, start_ns_);
  }

  void add(const FusedPose& pose) {
    comparison_.add(pose);
    whole_.add(pose);
    for (DriftMonitor& drift : drifts_) drift.add(pose);
  }

  void add(const UltrasonicFix& fix) { comparison_.add(fix); }

  void finish(const Case& test_case, const settings::Settings& settings, CaseResult& result) const {
    result.fused = comparison_.fused();
    result.last_fix_m = comparison_.last_fix_m();
    result.extrapolated_m = comparison_.extrapolated_m();
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
  std::vector<DriftMonitor> drifts_;
};

/// The middle value; the upper of the two for an even count. NaN counts as infinity.
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

void raise(std::optional<double>& most, double value) {
  most = std::max(most.value_or(value), value);
}

std::string seconds_or_none(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.2f}", *seconds) : "";
}

}  // namespace

Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed) {
  const sim::Run run{.seed = seed};
  const sim::Scenario drawn = sim::drawn(scenario, run);
  sim::Recording recording = sim::record(drawn, run);
  return {.name = std::string(drawn.name),
          .events = std::move(recording.events),
          .truth = std::move(recording.truth),
          .score_after_s = drawn.score_after_s,
          .outages = drawn.disturbances.outages,
          .relocations = drawn.disturbances.relocations};
}

Case recorded_case(const std::filesystem::path& folder) {
  recording::SensorLog log = recording::read_sensor_log(folder);
  if (log.truth.empty() || log.events.empty()) {
    throw files::IoError(folder.string() + ": has no truth.csv or no samples to compare with it");
  }
  Case test_case;
  test_case.name = folder.filename().string();
  test_case.events = std::move(log.events);
  test_case.truth = std::move(log.truth);
  return test_case;
}

std::vector<std::filesystem::path> recordings_with_truth(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(folder)) throw files::IoError(folder.string() + ": is not a folder");
  std::vector<fs::path> found;
  const auto consider = [&found](const fs::path& candidate) {
    const bool complete = exists(candidate / "imu.csv") && exists(candidate / "ultrasonic.csv") &&
                          exists(candidate / "truth.csv");
    if (complete) found.push_back(candidate);
  };
  consider(folder);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) consider(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

CaseResult evaluate(const Case& test_case, const settings::Settings& settings) {
  CaseResult result;
  result.name = test_case.name;
  result.engine = settings::to_text(settings::get(settings, "fusion.engine"));
  estimation::AnyEstimator estimator(settings);
  CaseRun run(test_case);
  for (const Event& event : test_case.events) {
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) run.add(*fix);
    const auto output = estimation::process(estimator, event);
    if (const auto* pose = std::get_if<FusedPose>(&output)) run.add(*pose);
  }
  result.fixes_used = estimator.counters().fixes_used;
  result.fixes_rejected = estimator.counters().fixes_rejected;
  run.finish(test_case, estimator.settings(), result);
  return result;
}

Summary summarise(const std::vector<CaseResult>& runs) {
  Summary summary;
  summary.name = runs.front().name;
  summary.engine = runs.front().engine;
  summary.runs = runs.size();
  const auto position = [](const CaseResult& run) {
    return std::isnan(run.fused.position_m.rmse) ? std::numeric_limits<double>::infinity()
                                                 : run.fused.position_m.rmse;
  };
  const std::vector<double> errors_m = each(runs, position);
  summary.position_rmse_m = median(errors_m);
  summary.worst_rmse_m = *std::max_element(errors_m.begin(), errors_m.end());
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
      raise(summary.slowest_recovery_s, outage.recovery_s);
      if (outage.drift_allowed_m > 0.0) {
        raise(summary.worst_drift_share, outage.drift_m / outage.drift_allowed_m);
      }
    }
    for (const RelocationResult& relocation : run.relocations) {
      raise(summary.slowest_recovery_s, relocation.settled_s);
    }
  }
  return summary;
}

double cost_of(const std::vector<std::vector<Case>>& cases, const settings::Settings& settings) {
  double logarithms = 0.0;
  for (const std::vector<Case>& runs : cases) {
    std::vector<CaseResult> results;
    for (const Case& run : runs) results.push_back(evaluate(run, settings));
    const Summary summary = summarise(results);
    logarithms += 0.5 * std::log(summary.position_rmse_m * summary.worst_rmse_m);
  }
  return std::exp(logarithms / static_cast<double>(cases.size()));
}

std::string table_of(const std::vector<Summary>& summaries) {
  std::size_t width = 15;
  for (const Summary& row : summaries) width = std::max(width, row.name.size());
  std::string text = fmt::format(
      "{:<{}} {:<10} {:>4} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n"
      "{:<{}} {:<10} {:>4} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n",
      "case", width, "engine", "runs", "pose", "worst", "p95", "last fix", "extrap.", "velocity", "yaw",
      "tilt", "recovery", "", width, "", "", "cm", "cm", "cm", "cm", "cm", "m/s", "deg", "deg", "s");
  for (const Summary& row : summaries) {
    text += fmt::format(
        "{:<{}} {:<10} {:>4} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.1f} {:>8.1f} {:>8.3f} {:>8.2f} {:>9.2f} {:>9}\n",
        row.name, width, row.engine, row.runs, 100 * row.position_rmse_m, 100 * row.worst_rmse_m,
        100 * row.position_p95_m, 100 * row.last_fix_rmse_m, 100 * row.extrapolated_rmse_m,
        row.velocity_rmse_mps, row.yaw_rmse_deg, row.tilt_rmse_deg, seconds_or_none(row.slowest_recovery_s));
  }
  return text;
}

std::string json_of(const std::vector<Summary>& summaries) {
  auto rows = nlohmann::ordered_json::array();
  for (const Summary& row : summaries) {
    nlohmann::ordered_json object{{"case", row.name},
                                  {"engine", row.engine},
                                  {"runs", row.runs},
                                  {"position_rmse_m", row.position_rmse_m},
                                  {"position_rmse_worst_m", row.worst_rmse_m},
                                  {"position_p95_m", row.position_p95_m},
                                  {"last_fix_rmse_m", row.last_fix_rmse_m},
                                  {"extrapolated_rmse_m", row.extrapolated_rmse_m},
                                  {"velocity_rmse_mps", row.velocity_rmse_mps},
                                  {"yaw_rmse_deg", row.yaw_rmse_deg},
                                  {"tilt_rmse_deg", row.tilt_rmse_deg}};
    if (row.slowest_recovery_s) object["slowest_recovery_s"] = *row.slowest_recovery_s;
    if (row.worst_drift_share) object["worst_drift_share"] = *row.worst_drift_share;
    rows.push_back(std::move(object));
  }
  return rows.dump(2) + "\n";
}

}  // namespace sonopose::evaluation
