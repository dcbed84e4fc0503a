#pragma once
/// \file
/// Reads a sensor-log folder: CSV files with a header line, times in ns since the Unix epoch.
///
/// | File             | Columns |
/// |------------------|---------|
/// | `imu.csv`        | timestamp, w_x, w_y, w_z [rad/s], a_x, a_y, a_z [m/s²], optional m_x, m_y, m_z [µT] |
/// | `ultrasonic.csv` | timestamp (emission), received, x, y, z [m], quality [%] |
/// | `heading.csv`    | timestamp (emission), received, heading [deg]; optional file |
/// | `twist.csv`      | timestamp, received, v(3) [m/s], optional std(3) [m/s], w(3) [rad/s]; optional file |
/// | `truth.csv`      | timestamp, p(3) [m], q_w, q_x, q_y, q_z, v(3) [m/s], …; optional file |
/// | `wheel_speed.csv` | timestamp, speed [m/s]; optional file, only used for scores |
/// | `meta.toml`      | what these files do not say (log_meta.hpp); optional file |
///
/// A time is at least 1 and below 2^62. An empty cell is an unknown value. Columns are found by their names,
/// and converted from the unit that the header names (csv/header.hpp). `quality` and all of the truth
/// but time and position are optional. Errors are files::IoError that name file, line, column and value.

#include "files/error.hpp"
#include "recording/log_files.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// The beacon address if neither meta.toml nor the user gives one.
inline constexpr BeaconAddress default_log_address = 7;

/// A complete recording.
struct SensorLog {
  std::vector<Event> events;       ///< events in the order in which a causal consumer receives them
  std::vector<TruthSample> truth;  ///< truth by time; NaN for unknown values; empty without a file
  BeaconAddress address = default_log_address;  ///< address of all samples
  std::vector<WheelSpeed> wheel_speeds{};       ///< speeds by time; empty without a file
  std::vector<std::string> warnings{};          ///< descriptions of missing or damaged parts
};

/// Reads a folder. Bridge and replay share this function, so both deliver the same events. `address` replaces
/// that of meta.toml. Throws files::IoError.
SensorLog read_sensor_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address = {});

/// The IMU samples of a recording, in file order and without sequence numbers.
struct ImuLog {
  std::vector<ImuSample> imu;
  std::vector<std::string> warnings;  ///< faults of the samples (input_check.hpp), and samples left out
};

/// Reads only the IMU samples of a folder. Throws files::IoError.
ImuLog read_imu_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address = {});

}  // namespace sonopose::recording
