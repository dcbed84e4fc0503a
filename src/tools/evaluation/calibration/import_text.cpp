#include "evaluation/calibration/import_text.hpp"

#include "calibration/drive/drive_fit.hpp"
#include "motion/imu_summary.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <variant>

namespace sonopose::evaluation {
namespace {

/// Number, rate and longest gap of a stream.
std::string stream_text(std::string_view name, std::vector<TimeNs> times_ns) {
  if (times_ns.size() < 2) return fmt::format("{:<12}{}\n", name, times_ns.size());
  std::ranges::sort(times_ns);
  std::vector<TimeNs> steps_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) steps_ns.push_back(times_ns[i] - times_ns[i - 1]);
  const auto longest = std::ranges::max_element(steps_ns);
  const double gap_at_s =
      seconds_between(times_ns.front(), times_ns[static_cast<std::size_t>(longest - steps_ns.begin())]);
  const double longest_s = seconds_between(0, *longest);
  std::erase(steps_ns, 0);  // of repeated rows
  if (steps_ns.empty()) return fmt::format("{:<12}{} with one stamp\n", name, times_ns.size());
  std::ranges::nth_element(steps_ns, steps_ns.begin() + static_cast<std::ptrdiff_t>(steps_ns.size() / 2));
  return fmt::format("{:<12}{} in {:.1f} s, usually {:.4g} Hz; the longest gap is {:.3g} s, at {:.1f} s\n",
                     name, times_ns.size(), seconds_between(times_ns.front(), times_ns.back()),
                     1e9 / static_cast<double>(std::max<TimeNs>(1, steps_ns[steps_ns.size() / 2])), longest_s,
                     gap_at_s);
}

std::string imu_text(const std::vector<motion::Reading>& readings) {
  const motion::ImuSummary imu = motion::summary_of(readings);
  Eigen::Index axis = 0;
  imu.mean_force_body_mps2.cwiseAbs().maxCoeff(&axis);
  constexpr std::string_view axes = "xyz";
  return fmt::format(
      "{:<12}{:.3g} m/s^2 (median), on average along {}{}; one sample of 20 turns faster than {:.3g} rad/s\n",
      "", imu.median_force_mps2, imu.mean_force_body_mps2[axis] < 0 ? '-' : '+',
      axes[static_cast<std::size_t>(axis)], imu.fast_rate_radps);
}

/// Begins the line of an offset that is not known well enough for a setting.
std::string rough_offset_text(const calibration::drive::Value& delay) {
  constexpr double max_half_width_s = 0.05;
  const double half_s = 0.5 * (delay.high - delay.low);
  if (!(half_s <= max_half_width_s)) return "offset not known: ";
  return fmt::format(
      "the positions are about {:.3f} s older than their times (95 %: {:.3f} to {:.3f}), too uncertain to "
      "correct: ",
      delay.value, delay.low, delay.high);
}

/// The offset of the clocks, and the setting that corrects it.
std::string clock_text(const recording::Tables& tables) {
  const auto line = [](const std::string& text) { return fmt::format("{:<12}{}\n", "clocks", text); };
  try {
    const auto fit =
        calibration::drive::calibrate_drive(std::span(&tables.log.events, 1), settings::Settings{});
    const calibration::drive::Value& delay = fit[calibration::drive::Quantity::delay];
    if (!delay.is_known()) return line(rough_offset_text(delay) + delay.missing);
    if (!fit.clock_fault.empty()) {
      return line(fmt::format("{}, or import again with --shift {:.3f}", fit.clock_fault,
                              seconds_between(0, tables.position_shift_ns) - delay.value));
    }
    return line(
        fmt::format("the positions are {:.3f} s older than their times (95 %: {:.3f} to {:.3f}); "
                    "replay with --set delay.correction_s={:.3f}",
                    delay.value, delay.low, delay.high, delay.value));
  } catch (const calibration::drive::CalibrationError& error) {
    return line(std::string("offset not known: ") + error.what());
  }
}

}  // namespace

std::string import_text(const recording::Tables& tables) {
  std::vector<TimeNs> imu_ns;
  std::vector<TimeNs> fixes_ns;
  std::vector<TimeNs> truth_ns;
  std::vector<motion::Reading> readings;
  for (const Event& event : tables.log.events) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      imu_ns.push_back(imu->sensor_time_ns);
      if (const auto reading = motion::reading_of(*imu)) readings.push_back(*reading);
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      fixes_ns.push_back(fix->emission_time_ns);
    }
  }
  for (const TruthSample& sample : tables.log.truth) truth_ns.push_back(sample.time_ns);
  std::string out = stream_text("IMU", std::move(imu_ns)) + imu_text(readings);
  const auto append_count = [&out](std::size_t count, std::string_view noun, std::string_view what) {
    if (count > 0) out += fmt::format("{:<12}{} {}\n", "", text::count_text(count, noun), what);
  };
  append_count(tables.rows_without_imu, "row", "that lack an IMU value left out");
  out += stream_text("positions", std::move(fixes_ns));
  if (!tables.has_height) out += fmt::format("{:<12}without z, which is taken as 0\n", "");
  append_count(tables.rows_without_position, "row", "without a position");
  append_count(tables.rows_of_other_tags, "row", "of other devices, which --tag chooses");
  append_count(tables.repeated_positions, "position", "that repeat the one before left out");
  if (!truth_ns.empty()) out += stream_text("truth", std::move(truth_ns));
  if (tables.times_moved_ns > 0) {
    out += fmt::format("{:<12}{:.3f} s added, since they begin at zero or before\n", "times",
                       seconds_between(0, tables.times_moved_ns));
  }
  for (const std::string& column : tables.unused_columns)
    out += fmt::format("{:<12}{}\n", "not used", column);
  if (!tables.unused_columns.empty()) {
    out += fmt::format(
        "{:<12}--column NAME=COLUMN uses one as NAME: m_x [uT], quality [%], received [s], tag…\n", "");
  }
  return out + clock_text(tables);
}

}  // namespace sonopose::evaluation
