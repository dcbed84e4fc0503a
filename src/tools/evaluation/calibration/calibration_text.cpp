#include "calibration/fit/terms.hpp"
#include "evaluation/calibration/calibration.hpp"
#include "evaluation/calibration/toml_text.hpp"
#include "toml/quoted.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <string_view>

namespace sonopose::evaluation {
namespace {

using calibration::fit::AccelerometerFit;
using calibration::fit::GyroscopeFit;
using calibration::fit::MagnetometerFit;

std::string line(std::string_view what, const std::string& text) {
  return fmt::format("{:<14} {}\n", what, text);
}

std::string periods(std::size_t count) {
  return text::count_text(count, "period");
}

std::string text_of(const AccelerometerFit& fit, const CalibrationResult& result) {
  std::string text = line("accelerometer", fmt::format("offset, sensitivity{} from {}",
                                                       fit.with_misalignment ? " and misalignment" : "",
                                                       text::count_text(fit.orientations, "orientation")));
  if (!fit.with_misalignment) text += line("", "no misalignment: " + fit.why_without);
  text += line("", fmt::format("|a| - g: {:.4f} m/s^2 RMS before, {:.4f} after", fit.rms_before_mps2,
                               fit.rms_after_mps2));
  return text +
         line("", fmt::format("worst: {:.4f} m/s^2, held still from {:.1f} s on", fit.worst_after_mps2,
                              seconds_between(result.begin_ns, result.still_begin_ns[fit.worst_period])));
}

std::string text_of(const GyroscopeFit& fit) {
  constexpr double degrees_per_radian = 1.0 / geometry::radians_per_degree;
  std::string text = line("gyroscope", fmt::format("offset from {} at rest", periods(fit.periods)));
  if (fit.with_sensitivity) {
    text += line("", fmt::format("sensitivity and misalignment from {}, {} left out",
                                 text::count_text(fit.turns, "turn"), fit.turns_left_out));
    text += line(
        "", fmt::format("gravity after a turn: {:.2f} deg RMS off before, {:.2f} after",
                        degrees_per_radian * fit.rms_before_rad, degrees_per_radian * fit.rms_after_rad));
  } else if (!fit.why_without.empty()) {
    text += line("", "no sensitivity and misalignment: " + fit.why_without);
  }
  return text;
}

std::string text_of(const MagnetometerFit& fit) {
  std::string text =
      line("magnetometer", fmt::format("{} of {} readings, {:.0f} % of the sphere's directions, {} disturbed",
                                       fit.used, fit.samples, 100.0 * fit.coverage, fit.outliers));
  text += line("", fmt::format("ellipsoid about ({:.2f}, {:.2f}, {:.2f}) uT, semi-axes {:.2f}, {:.2f} and "
                               "{:.2f} uT",
                               fit.centre_ut.x(), fit.centre_ut.y(), fit.centre_ut.z(), fit.semi_axes_ut.x(),
                               fit.semi_axes_ut.y(), fit.semi_axes_ut.z()));
  return text + line("", fmt::format("|m|: {:.3f} uT RMS off its mean before, {:.3f} off {:.2f} after",
                                     fit.rms_before_ut, fit.rms_after_ut, fit.field_ut));
}

/// Writes all settings of a group, so that no other configuration file can supply a missing one.
template <class Group>
std::string table_of(const Group& model, const Group& standard_errors, const std::string& prefix) {
  const auto terms = calibration::fit::terms_of(model);
  const auto errors = calibration::fit::terms_of(standard_errors);
  std::string text = fmt::format("\n[{}{}]\n", prefix, terms.front().info->group);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const settings::SettingInfo& row = *terms[i].info;
    const double error = errors[i].value;
    text += fmt::format("{} = {}", row.name, toml_number(terms[i].value));
    if (error > 0.0) text += fmt::format("  # +- {:.2g}{}{}", error, row.unit.empty() ? "" : " ", row.unit);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string calibration_text(const CalibrationResult& result) {
  std::string text = line("log", fmt::format("{}: {} over {:.1f} s", toml::quoted(result.log),
                                             text::count_text(result.samples, "sample"), result.duration_s));
  if (!result.still.empty()) text += line("still", periods(result.still.size()));
  if (result.accelerometer) text += text_of(*result.accelerometer, result);
  if (result.gyroscope) text += text_of(*result.gyroscope);
  if (result.magnetometer) text += text_of(*result.magnetometer);
  return text;
}

std::string calibration_toml(const CalibrationResult& result, std::optional<BeaconAddress> beacon) {
  const std::string prefix = beacon ? fmt::format("beacon.{}.", *beacon) : std::string();
  std::string text =
      commented("Written by sonopose-calibrate. For --config of the fusion.\n" + calibration_text(result));
  const auto append = [&](const auto& fit) {
    if (fit) text += table_of(fit->settings, fit->standard_errors, prefix);
  };
  append(result.accelerometer);
  append(result.gyroscope);
  append(result.magnetometer);
  return text;
}

}  // namespace sonopose::evaluation
