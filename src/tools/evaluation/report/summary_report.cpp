#include "evaluation/report/summary_report.hpp"

#include "evaluation/report/prediction_report.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::evaluation {
namespace {

std::string seconds_or_none(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.2f}", *seconds) : "";
}

/// Returns "–" for an unknown value.
std::string number(double value, int decimals) {
  return !std::isfinite(value) ? "–" : fmt::format("{:.{}f}", value, decimals);
}

std::string truth_header(std::size_t width) {
  return fmt::format(
      "{:<{}} {:<10} {:>4} {:>8} {:>8} {:>8} {:>8} {:>6} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n"
      "{:<{}} {:<10} {:>4} {:>8} {:>8} {:>8} {:>8} {:>6} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n",
      "case", width, "engine", "runs", "pose", "worst", "p95", "clear", "lost", "last fix", "extrap.",
      "velocity", "yaw", "tilt", "recovery", "", width, "", "", "cm", "cm", "cm", "cm", "s", "cm", "cm",
      "m/s", "deg", "deg", "s");
}

std::string truth_row(const Summary& row, std::size_t width) {
  if (!row.has_truth) {
    return fmt::format("{:<{}} {:<10} {:>4}  {}; its prediction errors follow\n", row.name, width, row.engine,
                       row.runs, row.truth_fault.empty() ? "no truth" : row.truth_fault);
  }
  if (!std::isfinite(row.position_rmse_m)) {
    return fmt::format("{:<{}} {:<10} {:>4}  no pose after the start is scored\n", row.name, width,
                       row.engine, row.runs);
  }
  return fmt::format(
      "{:<{}} {:<10} {:>4} {:>8} {:>8} {:>8} {:>8} {:>6} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n", row.name,
      width, row.engine, row.runs, number(100 * row.position_rmse_m, 2), number(100 * row.worst_rmse_m, 2),
      number(100 * row.position_p95_m, 2), number(100 * row.clear_rmse_m, 2), number(row.lost_s, 1),
      number(100 * row.last_fix_rmse_m, 1), number(100 * row.extrapolated_rmse_m, 1),
      number(row.velocity_rmse_mps, 3), number(row.yaw_rmse_deg, 2), number(row.tilt_rmse_deg, 2),
      seconds_or_none(row.slowest_recovery_s));
}

std::string prediction_table(const std::vector<Summary>& summaries, std::size_t width) {
  std::string text = fmt::format(
      "{:<{}} {:<10} {:>5} {:>8} {:>6} {:>6} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>8} {:>7}\n"
      "{:<{}} {:<10} {:>5} {:>8} {:>6} {:>6} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>8} {:>7}\n",
      "prediction", width, "engine", "fixes", "RMS", "p50", "p95", "along", "left", "up", "lag-1", "norm.",
      "gated", "heading", "wheel", "", width, "", "", "cm", "cm", "cm", "cm", "cm", "cm", "corr.", "sq.", "%",
      "deg", "m/s");
  for (const Summary& row : summaries) {
    const PredictionSummary& errors = row.prediction;
    text += fmt::format(
        "{:<{}} {:<10} {:>5} {:>8} {:>6} {:>6} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>8} {:>7}\n", row.name,
        width, row.engine, number(errors.fixes, 0), number(100 * errors.rms_m, 2),
        number(100 * errors.p50_m, 2), number(100 * errors.p95_m, 2), number(100 * errors.along_mean_m, 2),
        number(100 * errors.left_mean_m, 2), number(100 * errors.up_mean_m, 2), number(errors.lag_one, 2),
        number(errors.innovations, 2), number(100 * errors.gated_share, 1),
        number(errors.heading_rms_rad / geometry::radians_per_degree, 2),
        number(errors.wheel_speed_rms_mps, 3));
  }
  return text;
}

}  // namespace

SummaryTable::SummaryTable(std::size_t name_columns) : width_(std::max<std::size_t>(15, name_columns)) {}

std::string SummaryTable::add(Summary summary) {
  std::string lines = (rows_.empty() ? truth_header(width_) : "") + truth_row(summary, width_);
  rows_.push_back(std::move(summary));
  return lines;
}

std::string SummaryTable::predictions() const {
  return "\n" + prediction_table(rows_, width_);
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
                                  {"position_rmse_clear_m", row.clear_rmse_m},
                                  {"lost_s", row.lost_s},
                                  {"last_fix_rmse_m", row.last_fix_rmse_m},
                                  {"extrapolated_rmse_m", row.extrapolated_rmse_m},
                                  {"velocity_rmse_mps", row.velocity_rmse_mps},
                                  {"yaw_rmse_deg", row.yaw_rmse_deg},
                                  {"tilt_rmse_deg", row.tilt_rmse_deg},
                                  {"prediction", nlohmann::ordered_json::array()}};
    for (const PredictionScore& run : row.predictions) object["prediction"].push_back(prediction_json(run));
    if (row.slowest_recovery_s) object["slowest_recovery_s"] = *row.slowest_recovery_s;
    if (row.worst_drift_share) object["worst_drift_share"] = *row.worst_drift_share;
    rows.push_back(std::move(object));
  }
  return rows.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace sonopose::evaluation
