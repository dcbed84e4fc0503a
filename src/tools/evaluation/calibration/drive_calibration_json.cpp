#include "evaluation/calibration/drive_calibration.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace sonopose::evaluation {
namespace {

using Json = nlohmann::ordered_json;
using calibration::drive::Quantity;
using calibration::drive::Value;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const Value& value, std::string_view unit) {
  Json object{{"value", value.is_known() ? finite(value.value) : Json(nullptr)},
              {"low", finite(value.low)},
              {"high", finite(value.high)},
              {"unit", unit}};
  if (!value.is_known()) object["missing"] = value.missing;
  return object;
}

}  // namespace

std::string drive_json(const DriveCalibration& result) {
  const calibration::drive::DriveFit& fit = result.fit;
  const bool from_course = fit.mount_method == calibration::drive::MountMethod::course;
  Json object{{"logs", Json::array()},
              {"duration_s", result.duration_s},
              {"fixes", fit.fixes},
              {"fixes_used", fit.fixes_used},
              {"headings", fit.headings},
              {"headings_used", fit.headings_used},
              {"imu_silences", fit.imu_silences},
              {"used_s", fit.used_s},
              {"stamped_delay_s", fit.stamped_delay_s},
              {"stamped_delay_spread_s", fit.stamped_delay_spread_s},
              {"squared_fix_innovation", fit.squared_fix_innovation},
              {"squared_heading_innovation", fit.squared_heading_innovation},
              {"converged", fit.converged},
              {"mount_method", from_course ? "course" : "likelihood"}};
  for (const auto& log : result.logs) object["logs"].push_back(log.string());
  if (from_course) object["why_course"] = fit.why_course;
  if (!fit.clock_fault.empty()) object["clock_fault"] = fit.clock_fault;
  for (const Quantity quantity : result.wanted) {
    const auto at = static_cast<std::size_t>(quantity);
    Json& each = object["quantities"][std::string(choices_of(quantity)[at])] =
        json_of(fit[quantity], display_of(quantity).si_unit);
    for (const calibration::drive::CurvePoint& point : fit.curves.at(at)) {
      each["log_likelihood"].push_back({point.value, point.log_likelihood});
    }
  }
  return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sonopose::evaluation
