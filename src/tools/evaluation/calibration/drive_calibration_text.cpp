#include "evaluation/calibration/drive_calibration.hpp"
#include "evaluation/calibration/toml_text.hpp"
#include "toml/quoted.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace sonopose::evaluation {
namespace {

using calibration::drive::DriveFit;
using calibration::drive::MountMethod;
using calibration::drive::Quantity;
using calibration::drive::Value;

constexpr double degrees_per_radian = 1.0 / geometry::radians_per_degree;

constexpr std::array<Display, calibration::drive::quantity_count> displays{{
    {"mount", "deg", "rad", degrees_per_radian},
    {"delay correction", "ms", "s", 1e3},
    {"lever arm x", "mm", "m", 1e3},
    {"lever arm y", "mm", "m", 1e3},
    {"lever arm z", "mm", "m", 1e3},
    {"noise of fixes, x and y", "mm", "m", 1e3},
    {"noise of fixes, z", "mm", "m", 1e3},
    {"noise of headings", "deg", "rad", degrees_per_radian},
    {"noise of accelerometer", "mm/s^2/sqrt(Hz)", "m/s^2/sqrt(Hz)", 1e3},
    {"noise of gyroscope", "mrad/s/sqrt(Hz)", "rad/s/sqrt(Hz)", 1e3},
}};

std::string labelled(std::string_view what, const std::string& text) {
  return fmt::format("{:<24} {}\n", what, text);
}

std::string text_of(Quantity quantity, const Value& value) {
  const Display& as = display_of(quantity);
  const bool has_interval = std::isfinite(value.low) && std::isfinite(value.high);
  const std::string interval =
      has_interval ? fmt::format("between {:.3g} and {:.3g}", as.scale * value.low, as.scale * value.high)
                   : "any";
  if (!value.is_known()) return labelled(as.name, fmt::format("unknown ({}): {}", interval, value.missing));
  return labelled(as.name, fmt::format("{:.3g} {}, {}", as.scale * value.value, as.unit, interval));
}

std::string delay_text(const DriveFit& fit) {
  constexpr double milliseconds = 1e3;
  const Value& delay = fit[Quantity::delay];
  const double age_ms = milliseconds * (fit.stamped_delay_s + delay.value);
  std::string text =
      labelled("", fmt::format("a fix is {:.1f} ms old when it is received; its stamp says {:.1f} ms", age_ms,
                               milliseconds * fit.stamped_delay_s));
  if (fit.stamped_delay_s + delay.high < 0.0) {
    text +=
        labelled("", fmt::format("that is before it is measured: the stamps of the IMU are ahead, by {:.1f} "
                                 "ms if those of the fixes are right",
                                 -milliseconds * delay.value));
  }
  if (!fit.clock_fault.empty()) text += labelled("", "no setting can correct it: " + fit.clock_fault);
  return text;
}

/// Returns how the recordings were cut, if they were.
std::string silences_text(const DriveCalibration& result) {
  const DriveFit& fit = result.fit;
  if (fit.imu_silences == 0) return {};
  return labelled("", fmt::format("cut at {} of the IMU; the pieces of 6 s and more last {:.0f} s",
                                  text::count_text(fit.imu_silences, "silence"), fit.used_s));
}

/// Returns half of the interval in a setting's own unit: "+- 0.16 deg, 95 %".
std::string half_of(const Value& value, double scale, std::string_view unit) {
  return fmt::format("+- {:.2g} {}, 95 %", 0.5 * scale * (value.high - value.low), unit);
}

}  // namespace

const Display& display_of(Quantity quantity) {
  return displays.at(static_cast<std::size_t>(quantity));
}

std::string drive_text(const DriveCalibration& result) {
  const DriveFit& fit = result.fit;
  std::string text;
  for (const auto& log : result.logs) text += labelled("log", toml::quoted(log));
  text += labelled("", fmt::format("{:.0f} s; {} of {} fixes and {} of {} headings used", result.duration_s,
                                   fit.fixes_used, fit.fixes, fit.headings_used, fit.headings));
  text += silences_text(result);
  for (const Quantity quantity : result.wanted) {
    const Value& value = fit[quantity];
    text += text_of(quantity, value);
    if (quantity == Quantity::delay && value.is_known()) text += delay_text(fit);
    if (quantity == Quantity::mount && fit.mount_method == MountMethod::course) {
      text += labelled("", "from the direction of travel along the X axis: " + fit.why_course);
    }
  }
  return text + labelled("squared innovations",
                         fmt::format("{:.2f} of fixes, {:.2f} of headings; 1 if the noise is right",
                                     fit.squared_fix_innovation, fit.squared_heading_innovation));
}

std::vector<toml::Assignment> drive_settings(const DriveCalibration& result,
                                             std::optional<BeaconAddress> beacon) {
  const std::string prefix = beacon ? fmt::format("beacon.{}.", *beacon) : std::string();
  constexpr double decimals_deg = 1e3;
  constexpr double decimals_s = 1e5;
  const auto rounded = [](double value, double decimals) {
    return toml_number(std::round(value * decimals) / decimals);
  };
  std::vector<toml::Assignment> assignments;
  for (const Quantity quantity : result.wanted) {
    const Value& value = result.fit[quantity];
    if (!value.is_known()) continue;
    if (quantity == Quantity::mount) {
      assignments.push_back({prefix + "heading", "mount_offset_deg",
                             rounded(degrees_per_radian * value.value, decimals_deg),
                             half_of(value, degrees_per_radian, "deg")});
    } else if (quantity == Quantity::delay && result.fit.clock_fault.empty()) {
      assignments.push_back(
          {prefix + "delay", "correction_s", rounded(value.value, decimals_s), half_of(value, 1.0, "s")});
      if (result.has_fixed_delay) assignments.push_back({prefix + "delay", "source", "\"measured\"", {}});
    }
  }
  return assignments;
}

std::string drive_toml(const DriveCalibration& result, std::optional<BeaconAddress> beacon) {
  std::string text =
      commented("Written by sonopose-calibrate. For --config of the fusion.\n" + drive_text(result));
  std::string table;
  for (const toml::Assignment& each : drive_settings(result, beacon)) {
    if (each.table != table) text += fmt::format("\n[{}]\n", table = each.table);
    const std::string comment = each.comment.empty() ? "" : "  # " + each.comment;
    text += fmt::format("{} = {}{}\n", each.name, each.value, comment);
  }
  return text;
}

}  // namespace sonopose::evaluation
