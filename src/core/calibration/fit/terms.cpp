#include "calibration/fit/terms.hpp"

#include "calibration/fit/fit_support.hpp"

namespace sonopose::calibration::fit {
namespace {

std::vector<Term> terms_in(const settings::Settings& settings, std::string_view group) {
  std::vector<Term> terms;
  for (const auto& row : settings::setting_table()) {
    if (row.group != group) continue;
    terms.push_back({&row, std::get<double>(settings::get(settings, row.key))});
  }
  return terms;
}

}  // namespace

std::vector<Term> terms_of(const GyroscopeSettings& model) {
  settings::Settings all;
  all.calibration.gyroscope = model;
  return terms_in(all, "calibration.gyroscope");
}

std::vector<Term> terms_of(const AccelerometerSettings& model) {
  settings::Settings all;
  all.calibration.accelerometer = model;
  return terms_in(all, "calibration.accelerometer");
}

std::vector<Term> terms_of(const MagnetometerSettings& model) {
  settings::Settings all;
  all.calibration.magnetometer = model;
  return terms_in(all, "documented.calibration.magnetometer");
}

std::string out_of_range(const std::vector<Term>& terms) {
  for (const auto& [info, value] : terms) {
    const double minimum = std::get<double>(info->minimum);
    const double maximum = std::get<double>(info->maximum);
    if (value >= minimum && value <= maximum) continue;
    return info->key + " would be " + detail::text_of(value) + ", but only " + detail::text_of(minimum) +
           " … " + detail::text_of(maximum) +
           " is allowed: check that the recording has the values of this sensor in " +
           (info->unit.empty() ? "its unit" : info->unit);
  }
  return {};
}

}  // namespace sonopose::calibration::fit
