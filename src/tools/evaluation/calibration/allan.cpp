#include "evaluation/calibration/allan.hpp"

#include "bus_log/sensor_log.hpp"
#include "evaluation/calibration/calibration.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <optional>

namespace sonopose::evaluation {
namespace {

std::string cell(const std::optional<double>& value, double factor = 1.0) {
  return value ? fmt::format("{:>12.3g}", factor * *value) : fmt::format("{:>12}", "not seen");
}

}  // namespace

AllanResult analyse_allan(const std::filesystem::path& log, std::optional<BeaconAddress> beacon) {
  const auto imu = bus_log::read_imu_log(log, beacon);
  try {
    return {log, imu.size(), calibration::fit::analyse_allan(imu)};
  } catch (const calibration::fit::CalibrationError& error) {
    throw calibration::fit::CalibrationError(bus_log::imu_source(log).string() + ": " + error.what());
  }
}

std::string allan_text(const AllanResult& result) {
  constexpr double degrees_per_radian = 1.0 / geometry::radians_per_degree;
  constexpr double root_of_minutes_per_hour = 60.0;  // √(3600 s/h)
  constexpr double seconds_per_hour = 3600.0;
  const calibration::fit::AllanReport& report = result.report;
  std::string text =
      fmt::format("{}, {:.6g} s apart, over {:.1f} s\n", text::count_text(result.samples, "sample"),
                  report.period_s, report.duration_s);
  text += fmt::format("{:<16}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "density", "", "instability", "",
                      "at tau", "walk");
  for (std::size_t axis = 0; axis < calibration::fit::allan_axes.size(); ++axis) {
    const bool is_rate = axis < 3;
    if (axis % 3 == 0) {
      text += is_rate ? fmt::format("{:<16}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "rad/s/rtHz",
                                    "deg/rth", "rad/s", "deg/h", "s", "rad/s/rts")
                      : fmt::format("{:<16}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "m/s2/rtHz",
                                    "m/s/rth", "m/s2", "mg", "s", "m/s2/rts");
    }
    const calibration::fit::AllanNumbers& numbers = report.numbers[axis];
    const double density_factor = root_of_minutes_per_hour * (is_rate ? degrees_per_radian : 1.0);
    const double instability_factor =
        is_rate ? seconds_per_hour * degrees_per_radian : 1000.0 / standard_gravity_mps2;
    text += fmt::format("{:<16}", calibration::fit::allan_axes[axis]) + cell(numbers.noise_density) +
            cell(numbers.noise_density, density_factor) + cell(numbers.bias_instability) +
            cell(numbers.bias_instability, instability_factor) + cell(numbers.bias_instability_tau_s) +
            cell(numbers.rate_random_walk) + "\n";
  }
  return text;
}

}  // namespace sonopose::evaluation
