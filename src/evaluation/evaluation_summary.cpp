#include "evaluation/evaluation.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::evaluation {
namespace {

/// The middle one; of an even number the upper of the two.
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

Summary summarise(const std::vector<CaseResult>& runs) {
  Summary summary;
  summary.name = runs.front().name;
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
  std::string text = fmt::format(
      "{:<15} {:>4} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n"
      "{:<15} {:>4} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n",
      "case", "runs", "pose", "worst", "p95", "last fix", "extrap.", "velocity", "yaw", "tilt", "recovery",
      "", "", "cm", "cm", "cm", "cm", "cm", "m/s", "deg", "deg", "s");
  for (const Summary& row : summaries) {
    text += fmt::format(
        "{:<15} {:>4} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.1f} {:>8.1f} {:>8.3f} {:>8.2f} {:>9.2f} {:>9}\n",
        row.name, row.runs, 100 * row.position_rmse_m, 100 * row.worst_rmse_m, 100 * row.position_p95_m,
        100 * row.last_fix_rmse_m, 100 * row.extrapolated_rmse_m, row.velocity_rmse_mps, row.yaw_rmse_deg,
        row.tilt_rmse_deg, seconds_or_none(row.slowest_recovery_s));
  }
  return text;
}

std::string json_of(const std::vector<Summary>& summaries) {
  auto rows = nlohmann::ordered_json::array();
  for (const Summary& row : summaries) {
    nlohmann::ordered_json object{{"case", row.name},
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
