#pragma once
/// \file
/// Calibrates an installation from recordings of a drive. Writes the result as text, as JSON, and as settings
/// of the fusion.

#include "calibration/drive/drive_fit.hpp"
#include "toml/leaves.hpp"
#include "toml/merge.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::evaluation {

struct DriveRequest {
  std::vector<std::filesystem::path> logs;
  std::optional<BeaconAddress> beacon = {};  ///< beacon in files with several
  std::vector<calibration::drive::Quantity> wanted;
  settings::Settings settings;
  calibration::drive::DriveOptions options;
};

struct DriveCalibration {
  std::vector<std::filesystem::path> logs;
  std::vector<calibration::drive::Quantity> wanted;
  bool has_fixed_delay = false;  ///< the applied settings ignore the delay that fixes carry
  double duration_s = 0;         ///< duration of all logs
  calibration::drive::DriveFit fit;
};

/// Reads the logs. Throws files::IoError. Throws CalibrationError that names the logs if they do not suffice,
/// or, with the missing data, if none of the wanted quantities is known.
DriveCalibration calibrate_drive(const DriveRequest& request);

/// Name and units of a displayed quantity.
struct Display {
  std::string_view name;
  std::string_view unit;
  std::string_view si_unit;
  double scale;  ///< display units per SI unit
};

const Display& display_of(calibration::drive::Quantity quantity);

/// Writes one line per wanted quantity: the value and its interval, or what is missing.
std::string drive_text(const DriveCalibration& result);

/// Writes one JSON object; null for unknown values.
std::string drive_json(const DriveCalibration& result);

/// Returns the settings for known wanted quantities, of all beacons or of one.
std::vector<toml::Assignment> drive_settings(const DriveCalibration& result,
                                             std::optional<BeaconAddress> beacon);

/// Writes the same as a TOML file, preceded by the text as comments.
std::string drive_toml(const DriveCalibration& result, std::optional<BeaconAddress> beacon);

/// Returns the values in a file that override one of these settings for a single beacon. Throws
/// files::IoError.
std::vector<toml::Leaf> overriding(const std::filesystem::path& file,
                                   std::span<const toml::Assignment> settings);

}  // namespace sonopose::evaluation
