#pragma once
/// \file
/// Calibrations from a sensor log: found, told in words and as JSON, and written as the TOML tables that the
/// fusion reads.

#include "calibration/fit/inertial_fit.hpp"
#include "calibration/fit/magnetometer_fit.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// What was found in one log; the sensors that were not asked for are empty.
struct CalibrationResult {
  std::filesystem::path log;
  std::size_t samples = 0;
  double duration_s = 0;
  TimeNs begin_ns = 0;
  std::vector<calibration::StillInterval> still;
  std::vector<TimeNs> still_begin_ns;  ///< when each of the periods begins
  std::optional<calibration::AccelerometerFit> accelerometer;
  std::optional<calibration::GyroscopeFit> gyroscope;
  std::optional<calibration::MagnetometerFit> magnetometer;
};

/// The IMU samples of a log folder, of which only imu.csv is read. Throws files::IoError.
std::vector<ImuSample> read_imu_log(const std::filesystem::path& log);

// Each reads the log; each throws files::IoError, and CalibrationError that names the file.

/// Accelerometer and gyroscope, from orientations in which the sensor was held still.
CalibrationResult calibrate_imu(const std::filesystem::path& log);

/// The gyroscope's offset alone, from rest.
CalibrationResult calibrate_gyroscope(const std::filesystem::path& log);

/// `field_ut`: the strength that the corrected field is to have; empty: that of the raw readings about their
/// centre.
CalibrationResult calibrate_magnetometer(const std::filesystem::path& log, std::optional<double> field_ut);

/// The result for a person, a line per fact.
std::string calibration_text(const CalibrationResult& result);

/// The same as one JSON object, with every setting and its standard error.
std::string calibration_json(const CalibrationResult& result);

/// The settings as TOML tables that read back to the same bits, with the text as comments above. With a
/// beacon, they are that beacon's own.
std::string calibration_toml(const CalibrationResult& result, std::optional<BeaconAddress> beacon);

/// Puts `text` in the file's place as a whole. Throws files::IoError; the file then stays as it was.
void write_whole(const std::filesystem::path& file, const std::string& text);

}  // namespace sonopose::evaluation
