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
#include "recording/log_columns.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// The beacon address if neither meta.toml nor the user gives one.
inline constexpr BeaconAddress default_log_address = 7;

/// A measurement of the vehicle's odometer.
struct WheelSpeed {
  TimeNs time_ns = 0;
  double speed_mps = 0;  ///< speed; negative: backwards
};

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

/// Merges the streams and numbers the events from 1. An IMU sample comes at its stamp, any other at its
/// receipt; at equal times IMU, fix, heading, velocity. Each stream keeps its order: a row that is earlier
/// than its predecessor follows directly after it. Where the clock of all streams was set back, what came
/// before the step is merged before the rest.
///
/// Leaves out IMU samples with wrong stamps far in the future, which the estimators would follow, and says so
/// in the warnings, after `name`. A stamp counts as wrong if it is more than 1 s later than the stamp before
/// it and than most of the next 128, and the stamps then step back by more than 1 s.
SensorLog merge_by_availability(const std::string& name, const std::vector<ImuSample>& imu,
                                const std::vector<UltrasonicFix>& fixes,
                                const std::vector<PairHeading>& headings,
                                const std::vector<TwistSample>& twists = {});

/// Leaves the same samples out of events that are in order already, numbered from 1, and renumbers them.
void leave_far_ahead_out(const std::string& name, SensorLog& log);

/// The IMU samples of a table.
struct ImuTable {
  std::vector<ImuSample> samples;
  std::size_t rows_without_values = 0;  ///< rows that lack the time or a value, which are left out
  std::size_t incomplete_rows = 0;      ///< those of them that have a part of the vectors
};

/// Read single files, in file order and without sequence numbers. Each throws files::IoError. Only a layout
/// with given names leaves rows out.
std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address);
ImuTable read_imu_table(const std::filesystem::path& file, BeaconAddress address, const csv::Layout& layout);

/// Sets `measured_delay_s` to received − timestamp.
std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address);

/// Reads a row with an empty heading as an invalid sample.
std::vector<PairHeading> read_heading_csv(const std::filesystem::path& file, BeaconAddress address);

/// Reads an empty cell as an axis that was not measured, or a standard deviation that is unknown.
std::vector<TwistSample> read_twist_csv(const std::filesystem::path& file, BeaconAddress address);

/// Reads position, attitude and velocity, each NaN if unknown.
std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address,
                                        const csv::Layout& layout = truth_layout());

/// Leaves out rows without a speed.
std::vector<WheelSpeed> read_wheel_speed_csv(const std::filesystem::path& file);

}  // namespace sonopose::recording
