#include "evaluation/replay/attitude_run.hpp"

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/calibration/model/calibration.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::evaluation {
namespace {

bool is_scored(const recording::AttitudeLog& log, TimeNs time_ns) {
  return log.movements.empty() || std::any_of(log.movements.begin(), log.movements.end(),
                                              [time_ns](const auto& span) { return span.contains(time_ns); });
}

double rmse_deg(const std::vector<double>& errors_rad) {
  return error_summary_of(errors_rad).rmse / geometry::radians_per_degree;
}

std::string figure(double value_deg) {
  return std::isnan(value_deg) ? fmt::format("{:>12}", "-") : fmt::format("{:12.2f}", value_deg);
}

std::string row(const AttitudeResult& result, std::size_t width) {
  return fmt::format("{:<{}}{:>9}{}{}{}\n", result.name, width, result.scored, figure(result.total_rmse_deg),
                     figure(result.heading_rmse_deg), figure(result.inclination_rmse_deg));
}

nlohmann::ordered_json json_of(const AttitudeResult& result) {
  const auto number = [](double value) {
    return std::isnan(value) ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(value);
  };
  return {{"log", result.name},
          {"samples", result.samples},
          {"rejected", result.rejected},
          {"scored", result.scored},
          {"total_rmse_deg", number(result.total_rmse_deg)},
          {"heading_rmse_deg", number(result.heading_rmse_deg)},
          {"inclination_rmse_deg", number(result.inclination_rmse_deg)}};
}

}  // namespace

AttitudeResult run_attitude(const std::string& name, const recording::AttitudeLog& log,
                            const settings::Settings& settings,
                            const std::function<void(TimeNs, const Quaterniond&)>& on_orientation) {
  attitude::Tracker<attitude::AnyFilter> tracker(settings.attitude, field_use(settings.attitude.selection));
  const calibration::Calibration calibration(settings.calibration);
  TruthTrack truth(log.truth);
  AttitudeResult result;
  std::pair<TimeNs, Quaterniond> before{
      0, Quaterniond::Identity()};  // time and orientation of the sample before
  std::vector<double> total_rad;
  std::vector<double> heading_rad;
  std::vector<double> inclination_rad;
  for (const ImuSample& imu : log.imu) {
    ++result.samples;
    if (!tracker.on(calibration.corrected(imu))) {
      ++result.rejected;
      continue;
    }
    const Quaterniond q_body_to_world = tracker.filter().orientation();
    const TimeNs before_ns = std::exchange(before.first, imu.sensor_time_ns);
    const Quaterniond q_before = std::exchange(before.second, q_body_to_world);
    if (on_orientation) on_orientation(imu.sensor_time_ns, q_body_to_world);
    if (!is_scored(log, imu.sensor_time_ns)) continue;
    const auto known = truth.at_or_since(before_ns, imu.sensor_time_ns);
    if (!known || !known->q_body_to_world.coeffs().allFinite()) continue;
    const double span_s = seconds_between(before_ns, imu.sensor_time_ns);
    const Quaterniond q_compared =
        known->time_ns == imu.sensor_time_ns
            ? q_body_to_world
            : q_before.slerp(seconds_between(before_ns, known->time_ns) / span_s, q_body_to_world);
    const AttitudeError error = error_of(q_compared, known->q_body_to_world);
    total_rad.push_back(error.total_rad);
    heading_rad.push_back(error.heading_rad);
    inclination_rad.push_back(error.inclination_rad);
  }
  result.name = name;
  result.scored = total_rad.size();
  result.total_rmse_deg = rmse_deg(total_rad);
  result.heading_rmse_deg = rmse_deg(heading_rad);
  result.inclination_rmse_deg = rmse_deg(inclination_rad);
  return result;
}

AttitudeResult mean_of(const std::vector<AttitudeResult>& results) {
  AttitudeResult mean;
  mean.name = "mean";
  for (const AttitudeResult& result : results) {
    mean.samples += result.samples;
    mean.rejected += result.rejected;
    if (result.scored == 0) continue;
    ++mean.scored;
    mean.total_rmse_deg += result.total_rmse_deg;
    mean.heading_rmse_deg += result.heading_rmse_deg;
    mean.inclination_rmse_deg += result.inclination_rmse_deg;
  }
  const auto count = static_cast<double>(mean.scored);  // no log scored: 0/0 is NaN, unknown
  mean.total_rmse_deg /= count;
  mean.heading_rmse_deg /= count;
  mean.inclination_rmse_deg /= count;
  return mean;
}

std::string attitude_text(const std::vector<AttitudeResult>& results) {
  std::size_t width = 6;
  for (const AttitudeResult& result : results) width = std::max(width, result.name.size() + 1);
  std::string text = fmt::format("{:<{}}{:>9}{:>12}{:>12}{:>12}\n", "RMS, deg", width, "scored", "total",
                                 "heading", "inclination");
  for (const AttitudeResult& result : results) text += row(result, width);
  if (results.size() > 1) text += row(mean_of(results), width);
  for (const AttitudeResult& result : results) {
    if (result.rejected == 0) continue;
    text += fmt::format(
        "{}: {} of {} samples rejected: earlier than the one before, far after it, or no measurement\n",
        result.name, result.rejected, result.samples);
  }
  return text;
}

std::string attitude_json(const std::vector<AttitudeResult>& results) {
  nlohmann::ordered_json json{{"logs", nlohmann::ordered_json::array()}};
  for (const AttitudeResult& result : results) json["logs"].push_back(json_of(result));
  json["mean"] = json_of(mean_of(results));
  json["mean"].erase("log");
  json["mean"]["logs_scored"] = json["mean"]["scored"];
  json["mean"].erase("scored");
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace sonopose::evaluation
