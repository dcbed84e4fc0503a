#include "evaluation/report/prediction_report.hpp"

#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::evaluation {
namespace {

std::string row(std::string_view what, const std::string& text) {
  return fmt::format("{:<12} {}\n", what, text);
}

/// Returns the mean and the RMS error: "along +0.3 (2.1)".
std::string signed_cm(std::string_view direction, const SignedErrors& errors) {
  if (errors.mean != errors.mean) return fmt::format("{} –", direction);
  return fmt::format("{} {:+.1f} ({:.1f})", direction, 100.0 * errors.mean, 100.0 * errors.rms);
}

/// Returns "–" for an unknown value.
std::string known(double value, int decimals) {
  return std::isnan(value) ? "–" : fmt::format("{:.{}f}", value, decimals);
}

std::string innovations_text(const std::optional<NormalisedInnovations>& innovations, bool has_used) {
  if (!innovations && !has_used) return "not known: no fix was used without doubt";
  if (!innovations) return "not known: this engine reports no covariance";
  return fmt::format("{:8.2f} squared, per degree of freedom; {:.2f} to {:.2f} if the covariances are right",
                     innovations->mean, innovations->low, innovations->high);
}

/// Returns one line; nothing if there were no measurements.
std::string quantity_line(std::string_view what, const PredictedQuantity& quantity, double factor,
                          std::string_view unit) {
  if (quantity.count == 0) return {};
  return row(what, fmt::format("{:8.3f} {} RMS, {:.3f} p95, mean {:+.3f}, lag-1 correlation {}, over {}",
                               factor * quantity.error.rms, unit, factor * quantity.p95,
                               factor * quantity.error.mean, known(quantity.lag_one, 2), quantity.count));
}

nlohmann::ordered_json json_of(const SignedErrors& errors) {
  return {{"mean", errors.mean}, {"rms", errors.rms}};
}

nlohmann::ordered_json json_of(const PredictedQuantity& quantity) {
  if (quantity.count == 0) return {};
  return {{"count", quantity.count}, {"mean", quantity.error.mean}, {"rms", quantity.error.rms},
          {"p50", quantity.p50},     {"p95", quantity.p95},         {"lag_one", quantity.lag_one}};
}

nlohmann::ordered_json json_of(const std::optional<NormalisedInnovations>& innovations,
                               const char* measurements) {
  if (!innovations) return nullptr;
  return {{measurements, innovations->count},
          {"mean_squared", innovations->mean},
          {"expected_low", innovations->low},
          {"expected_high", innovations->high}};
}

}  // namespace

std::string prediction_text(const PredictionScore& score) {
  if (score.fixes.empty()) {
    return row("predicted", score.fixes_without == 0 ? "no fix in the scored time"
                                                     : "no fix: none has a pose at its emission");
  }
  std::string text = row(
      "predicted",
      fmt::format("{:8.4f} m RMS from pose to fix, {:.4f} m p50, {:.4f} m p95, over {}, {} without a pose",
                  score.distance_m.rmse, score.distance_p50_m, score.distance_m.p95,
                  text::count_text(score.fixes.size(), "fix", "fixes"), score.fixes_without));
  text += row("", fmt::format("trusted fixes, mean (RMS) in cm: {}, {}, {}; lag-1 correlation {}; {} % gated",
                              signed_cm("along", score.along_m), signed_cm("left", score.left_m),
                              signed_cm("up", score.up_m), known(score.lag_one, 2),
                              known(100.0 * score.gated_share, 1)));
  const bool has_used = std::ranges::any_of(score.fixes, &FixError::trusted);
  text += row("innovations", innovations_text(score.innovations, has_used));
  text += quantity_line("heading", score.heading_rad, 1.0 / geometry::radians_per_degree, "deg");
  if (score.heading_innovations) text += row("", innovations_text(score.heading_innovations, true));
  return text + quantity_line("wheel speed", score.wheel_speed_mps, 1.0, "m/s");
}

nlohmann::ordered_json prediction_json(const PredictionScore& score) {
  // The JSON library writes NaN (unknown) as null.
  return {{"fixes", score.fixes.size()},
          {"fixes_without_pose", score.fixes_without},
          {"distance_rms_m", score.distance_m.rmse},
          {"distance_p50_m", score.distance_p50_m},
          {"distance_p95_m", score.distance_m.p95},
          {"distance_max_m", score.distance_m.max},
          {"along_m", json_of(score.along_m)},
          {"left_m", json_of(score.left_m)},
          {"up_m", json_of(score.up_m)},
          {"lag_one", score.lag_one},
          {"gated_share", score.gated_share},
          {"innovations", json_of(score.innovations, "fixes")},
          {"heading_rad", json_of(score.heading_rad)},
          {"heading_innovations", json_of(score.heading_innovations, "headings")},
          {"wheel_speed_mps", json_of(score.wheel_speed_mps)}};
}

}  // namespace sonopose::evaluation
