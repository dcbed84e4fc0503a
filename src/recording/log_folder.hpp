#pragma once
/// \file
/// Reads a sensor-log folder: plain CSV files with a `#` header line, times in integer ns since the Unix
/// epoch.
///
/// | File             | Columns |
/// |------------------|---------|
/// | `imu.csv`        | timestamp, w_x, w_y, w_z [rad/s], a_x, a_y, a_z [m/s²], optional m_x, m_y, m_z [µT] |
/// | `ultrasonic.csv` | timestamp (emission), received, x, y, z [m], quality [%] |
/// | `heading.csv`    | timestamp (emission), received, heading [deg]; optional file |
/// | `truth.csv`      | timestamp, p(3) [m], q_w, q_x, q_y, q_z, v(3) [m/s], …; optional file |
/// | `wheel_speed.csv` | timestamp, speed [m/s]; optional file, only used for scores |
/// | `meta.toml`      | what these files do not say (log_meta.hpp); optional file |
///
/// A time is at least 1 and below 2^62. An empty cell is an unknown value. Columns are identified by
/// position, as in EuRoC's files; the header's text is ignored. Errors are files::IoError that name file,
/// line, column and value.

#include "files/error.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// The address of a log's beacon if neither its meta.toml nor the user names one.
inline constexpr BeaconAddress default_log_address = 7;

/// What an odometer of the vehicle measured.
struct WheelSpeed {
  TimeNs time_ns = 0;
  double speed_mps = 0;  ///< negative: backwards
};

/// A whole recording.
struct SensorLog {
  std::vector<Event> events;       ///< in the order in which a causal consumer receives them
  std::vector<TruthSample> truth;  ///< as in the file; NaN for unknown values; empty without a file
  BeaconAddress address = default_log_address;  ///< of all samples
  std::vector<WheelSpeed> wheel_speeds{};       ///< in ascending time; empty without a file
  std::vector<std::string> warnings{};          ///< what is missing or damaged, in words
};

/// Reads a folder. Bridge and replay share this function, so that both deliver the same events. `address`
/// replaces that of meta.toml. Throws files::IoError.
SensorLog read_sensor_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address = {});

/// The IMU samples of a folder in file order and without sequence numbers, for readers that use nothing else.
/// Throws files::IoError.
std::vector<ImuSample> read_imu_log(const std::filesystem::path& folder,
                                    std::optional<BeaconAddress> address = {});

/// Merges the three streams, numbered from 1: an IMU sample at its time, a fix and a heading at their
/// receipt; at equal times IMU, fix, heading. Each stream keeps its order: a row that is earlier than the row
/// before it in its file comes directly after that row.
///
/// A wrong IMU stamp far in the future does not delay other events. If a sample's stamp is more than 1 s
/// later than that of the sample before it, and than that of at least one of the next 64 samples which is not
/// itself more than 1 s earlier than the sample before, the sample is merged as if it had the earliest such
/// stamp. Its stamp is not changed. Smaller delays, as over a bad line, are merged by stamp.
std::vector<Event> merge_by_availability(const std::vector<ImuSample>& imu,
                                         const std::vector<UltrasonicFix>& fixes,
                                         const std::vector<PairHeading>& headings);

/// Single files, in file order and without sequence numbers. Each throws files::IoError.
std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address,
                                    ImuMeaning meaning = ImuMeaning::unknown);

/// `measured_delay_s` is received − timestamp.
std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address);

/// A row with an empty heading becomes a sample that is not valid.
std::vector<PairHeading> read_heading_csv(const std::filesystem::path& file, BeaconAddress address);

/// Position, attitude and velocity, each NaN if unknown. Further columns are ignored.
std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address);

/// Sorted by time; rows without a speed are left out.
std::vector<WheelSpeed> read_wheel_speed_csv(const std::filesystem::path& file);

}  // namespace sonopose::recording
