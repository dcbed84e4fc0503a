#pragma once
/// \file
/// Calibrates an installation from recordings of a drive: as text, as JSON, and as settings of the fusion.

#include "calibration/drive/drive_fit.hpp"
#include "files/toml/merge.hpp"
#include "files/toml/toml_leaves.hpp"
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
  std::optional<BeaconAddress> beacon = {};  ///< of the files that have several
  std::vector<calibration::drive::Quantity> wanted;
  settings::Settings settings;
  calibration::drive::DriveOptions options;
};

struct DriveCalibration {
  std::vector<std::filesystem::path> logs;
  std::vector<calibration::drive::Quantity> wanted;
  bool has_fixed_delay = false;  ///< the settings used ignore the delay that fixes carry
  double duration_s = 0;         ///< of all logs
  calibration::drive::DriveFit fit;
};

/// Reads the logs. Throws files::IoError, and CalibrationError that names the logs if they do not suffice, or
/// if none of the wanted quantities is known: it then says what is missing.
DriveCalibration calibrate_drive(const DriveRequest& request);

/// How a quantity is displayed.
struct Display {
  std::string_view name;
  std::string_view unit;
  std::string_view si_unit;
  double scale;  ///< unit per SI unit
};

const Display& display_of(calibration::drive::Quantity quantity);

/// One line per wanted quantity: the value and its interval, or what is missing.
std::string drive_text(const DriveCalibration& result);

/// One JSON object; null for what is not known.
std::string drive_json(const DriveCalibration& result);

/// The settings for what is wanted and known, of all beacons or of one.
std::vector<files::toml::Assignment> drive_settings(const DriveCalibration& result,
                                                    std::optional<BeaconAddress> beacon);

/// The same as a TOML file, preceded by the text as comments.
std::string drive_toml(const DriveCalibration& result, std::optional<BeaconAddress> beacon);

/// The values in a file that apply to a single beacon in place of one of these settings. Throws
/// files::IoError.
std::vector<files::toml::Leaf> overriding(const std::filesystem::path& file,
                                          std::span<const files::toml::Assignment> settings);

}  // namespace sonopose::evaluation
