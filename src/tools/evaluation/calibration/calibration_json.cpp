#include "calibration/fit/terms.hpp"
#include "evaluation/calibration/allan.hpp"
#include "evaluation/calibration/calibration.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace sonopose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

/// Replaces invalid bytes, since paths may contain invalid UTF-8.
std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

template <class Group>
Json json_of(const Group& settings) {
  Json object = Json::object();
  for (const auto& [info, value] : calibration::fit::terms_of(settings)) object[info->name] = value;
  return object;
}

template <class Fit>
Json settings_of(const Fit& fit) {
  return {{"settings", json_of(fit.settings)}, {"standard_errors", json_of(fit.standard_errors)}};
}

Json json_of(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

std::string calibration_json(const CalibrationResult& result) {
  Json object{{"log", result.log.string()}, {"samples", result.samples}, {"duration_s", result.duration_s}};
  if (!result.still.empty()) object["still_periods"] = result.still.size();
  if (const auto& fit = result.accelerometer) {
    Json& sensor = object["accelerometer"] = settings_of(*fit);
    sensor["orientations"] = fit->orientations;
    sensor["with_misalignment"] = fit->with_misalignment;
    sensor["rms_before_mps2"] = fit->rms_before_mps2;
    sensor["rms_after_mps2"] = fit->rms_after_mps2;
    sensor["worst_after_mps2"] = fit->worst_after_mps2;
  }
  if (const auto& fit = result.gyroscope) {
    Json& sensor = object["gyroscope"] = settings_of(*fit);
    sensor["periods"] = fit->periods;
    sensor["turns"] = fit->turns;
    sensor["turns_left_out"] = fit->turns_left_out;
    sensor["with_sensitivity"] = fit->with_sensitivity;
    sensor["rms_before_rad"] = fit->rms_before_rad;
    sensor["rms_after_rad"] = fit->rms_after_rad;
  }
  if (const auto& fit = result.magnetometer) {
    Json& sensor = object["magnetometer"] = settings_of(*fit);
    sensor["readings"] = fit->samples;
    sensor["used"] = fit->used;
    sensor["disturbed"] = fit->outliers;
    sensor["coverage"] = fit->coverage;
    sensor["centre_ut"] = json_of(fit->centre_ut);
    sensor["semi_axes_ut"] = json_of(fit->semi_axes_ut);
    sensor["field_ut"] = fit->field_ut;
    sensor["rms_before_ut"] = fit->rms_before_ut;
    sensor["rms_after_ut"] = fit->rms_after_ut;
  }
  return dumped(object);
}

std::string allan_json(const AllanResult& result) {
  Json object{{"log", result.log.string()},
              {"samples", result.samples},
              {"duration_s", result.report.duration_s},
              {"period_s", result.report.period_s}};
  for (std::size_t axis = 0; axis < calibration::fit::allan_axes.size(); ++axis) {
    const calibration::fit::AllanNumbers& numbers = result.report.numbers[axis];
    Json row{{"axis", calibration::fit::allan_axes[axis]},
             {"noise_density", json_of(numbers.noise_density)},
             {"bias_instability", json_of(numbers.bias_instability)},
             {"bias_instability_tau_s", json_of(numbers.bias_instability_tau_s)},
             {"rate_random_walk", json_of(numbers.rate_random_walk)},
             {"curve", Json::array()}};
    for (const calibration::fit::AllanPoint& point : result.report.curves[axis]) {
      row["curve"].push_back({point.tau_s, point.deviation, point.relative_error});
    }
    object["axes"].push_back(std::move(row));
  }
  return dumped(object);
}

}  // namespace sonopose::evaluation
