#pragma once
/// \file
/// Reads a sensor-log folder: plain CSV files with a `#` header line, times in integer ns since the Unix
/// epoch.
///
/// | File             | Columns |
/// |------------------|---------|
/// | `imu.csv`        | timestamp, w_x, w_y, w_z [rad/s], a_x, a_y, a_z [m/s²], optional m_x, m_y, m_z [µT] |
/// | `ultrasonic.csv` | timestamp (emission), received, x, y, z [m], quality [%] |
/// | `heading.csv`    | timestamp (emission), received, heading [deg]; the file may be absent |
/// | `truth.csv`      | timestamp, p(3) [m], q_w, q_x, q_y, q_z, v(3) [m/s], …; the file may be absent |
///
/// A time is at least 1 and below 2^62. An empty cell is an unknown value. Columns count by their place, as
/// in EuRoC's files; the header's words are not compared. Whatever is wrong is an files::IoError that names file,
/// line, column and value.

#include <sonopose/samples/samples.hpp>
#include "files/error.hpp"

#include <filesystem>
#include <vector>

namespace sonopose::recording {

/// The address that a log's beacon gets where nobody says otherwise: a log holds one beacon and not its
/// address.
inline constexpr BeaconAddress default_log_address = 7;

/// A whole recording.
struct SensorLog {
  std::vector<Event> events;       ///< in the order in which a causal user gets them
  std::vector<TruthSample> truth;  ///< as in the file; NaN where a value is not known; empty without a file
};

/// Reads a folder. Its events are what the bridge publishes and what a replay gives the engine: this one
/// function for both is what makes them the same. Throws files::IoError.
SensorLog read_sensor_log(const std::filesystem::path& folder, BeaconAddress address = default_log_address);

/// The three streams as one, numbered from 1: an IMU sample at its time, a fix and a heading when they were
/// received; at equal times IMU, fix, heading. No stream's own order is changed: a row that is earlier than
/// the row before it in its file comes right after that row.
///
/// A wrong IMU stamp far in the future holds nothing up. A sample whose stamp is more than 1 s later than
/// that of the sample before it, and than one of the 64 samples after it which is not itself more than 1 s
/// earlier than the sample before, comes as if it had the earliest such stamp. Its stamp stays as it is. What
/// comes late by less, as over a bad line, is merged by its stamp.
std::vector<Event> merge_by_availability(const std::vector<ImuSample>& imu,
                                         const std::vector<UltrasonicFix>& fixes,
                                         const std::vector<PairHeading>& headings);

/// Single files, in file order and without sequence numbers. Each throws files::IoError.
std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address);

/// `measured_delay_s` is received − timestamp.
std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address);

/// A row with an empty heading is a sample that says "not valid".
std::vector<PairHeading> read_heading_csv(const std::filesystem::path& file, BeaconAddress address);

/// Position, attitude and velocity; each of them NaN where it is not known. Further columns are not read.
std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address);

}  // namespace sonopose::recording
