#pragma once
/// \file
/// Calibrates sensors from a log. Writes the result as text, as JSON, and as the TOML tables that the fusion
/// reads.

#include "calibration/fit/inertial_fit.hpp"
#include "calibration/fit/magnetometer_fit.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// The result for one log; empty for the sensors that were not requested.
struct CalibrationResult {
  std::filesystem::path log;
  std::size_t samples = 0;
  double duration_s = 0;
  TimeNs begin_ns = 0;
  std::vector<calibration::fit::StillInterval> still;
  std::vector<TimeNs> still_begin_ns;  ///< begin of each still interval
  std::optional<calibration::fit::AccelerometerFit> accelerometer;
  std::optional<calibration::fit::GyroscopeFit> gyroscope;
  std::optional<calibration::fit::MagnetometerFit> magnetometer;
};

// Each function reads the log, and in a file with several beacons that of `beacon`. Throws files::IoError,
// and a CalibrationError that names the file.

/// Calibrates accelerometer and gyroscope from orientations in which the sensor was still.
CalibrationResult calibrate_imu(const std::filesystem::path& log, std::optional<BeaconAddress> beacon = {});

/// Calibrates only the gyroscope offset, from rest.
CalibrationResult calibrate_gyroscope(const std::filesystem::path& log,
                                      std::optional<BeaconAddress> beacon = {});

/// `field_ut`: strength of the corrected field; if empty, the mean strength of the raw readings about their
/// centre.
CalibrationResult calibrate_magnetometer(const std::filesystem::path& log, std::optional<double> field_ut,
                                         std::optional<BeaconAddress> beacon = {});

/// Writes the result as readable lines.
std::string calibration_text(const CalibrationResult& result);

/// Writes the result as one JSON object, with every setting and its standard error.
std::string calibration_json(const CalibrationResult& result);

/// Writes the settings as TOML tables that read back to the same bits, preceded by the text as comments. With
/// a beacon, the tables apply only to that beacon.
std::string calibration_toml(const CalibrationResult& result, std::optional<BeaconAddress> beacon);

}  // namespace sonopose::evaluation
