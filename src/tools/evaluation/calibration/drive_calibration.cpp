#include "evaluation/calibration/drive_calibration.hpp"

#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "logging/log.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/calibration/model/axes_check.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::evaluation {
namespace {

using calibration::drive::CalibrationError;
using calibration::drive::Quantity;

std::string names_of(const std::vector<std::filesystem::path>& logs) {
  std::string names;
  for (const auto& log : logs) names += (names.empty() ? "" : ", ") + log.string();
  return names;
}

/// Warns of a mount that gravity contradicts: the result would be right only for a body that lies as the IMU.
void warn_of_axes(const std::string& name, const std::vector<Event>& events,
                  const calibration::Settings& settings) {
  calibration::AxesCheck axes(settings);
  for (const Event& event : events) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) axes.on(*imu);
  }
  if (const auto problem = axes.problem()) {
    logging::warning(fmt::format("{}: {}: {}", name, problem->text, problem->remedy));
  }
}

/// Throws if no wanted quantity is known, or only a delay that the fusion cannot correct.
void check(const DriveCalibration& result) {
  std::string missing;
  const char* problem = "not observable";
  for (const Quantity quantity : result.wanted) {
    const calibration::drive::Value& value = result.fit[quantity];
    const bool is_correctable = quantity != Quantity::delay || result.fit.clock_fault.empty();
    if (value.is_known() && is_correctable) return;
    if (!is_correctable) problem = "no setting can correct it";
    missing += fmt::format("; {}: {}", choices_of(quantity)[static_cast<std::size_t>(quantity)],
                           is_correctable ? value.missing : result.fit.clock_fault);
  }
  throw CalibrationError(fmt::format("{}: {}{}", names_of(result.logs), problem, missing));
}

}  // namespace

DriveCalibration calibrate_drive(const DriveRequest& request) {
  DriveCalibration result;
  result.logs = request.logs;
  result.wanted = request.wanted;
  result.has_fixed_delay = request.settings.delay.source == settings::DelaySource::fixed;
  std::vector<std::vector<Event>> recordings;
  for (const auto& log : request.logs) {
    recordings.push_back(
        bus_log::read_sensor_log(log, bus_log::is_log_folder(log) ? std::nullopt : request.beacon).events);
    if (recordings.back().empty()) throw CalibrationError(log.string() + ": has no samples");
    warn_of_axes(log.string(), recordings.back(), request.settings.calibration);
    result.duration_s += seconds_between(available_at_ns(recordings.back().front()),
                                         available_at_ns(recordings.back().back()));
  }
  try {
    result.fit = calibration::drive::calibrate_drive(recordings, request.settings, request.options);
  } catch (const CalibrationError& error) {
    throw CalibrationError(names_of(request.logs) + ": " + error.what());
  }
  check(result);
  return result;
}

std::vector<toml::Leaf> overriding(const std::filesystem::path& file,
                                   std::span<const toml::Assignment> settings) {
  constexpr std::string_view prefix = "beacon.";
  std::vector<toml::Leaf> found;
  for (toml::Leaf& leaf : toml::read_leaves(file)) {
    const std::string_view key = leaf.key;
    const std::size_t behind_address = key.find('.', prefix.size());
    if (!key.starts_with(prefix) || behind_address == std::string_view::npos) continue;
    const std::string_view setting = key.substr(behind_address + 1);
    const bool overrides = std::any_of(
        settings.begin(), settings.end(),
        [setting](const toml::Assignment& each) { return setting == each.table + "." + each.name; });
    if (overrides) found.push_back(std::move(leaf));
  }
  return found;
}

}  // namespace sonopose::evaluation
