#pragma once
/// \file
/// Reads a log of an attitude benchmark: IMU and truth as in every sensor-log folder (log_folder.hpp), no
/// fixes, and the spans in which the body moves.
///
/// | File           | Columns |
/// |----------------|---------|
/// | `movement.csv` | start, end [ns]; optional; without it the whole log counts |

#include "files/error.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// A span including both endpoints.
struct TimeSpan {
  TimeNs start_ns = 0;
  TimeNs end_ns = 0;

  [[nodiscard]] bool contains(TimeNs time_ns) const { return start_ns <= time_ns && time_ns <= end_ns; }
};

struct AttitudeLog {
  std::vector<ImuSample> imu;
  std::vector<TruthSample> truth;       ///< NaN for unknown values; empty without a file
  std::vector<TimeSpan> movements;      ///< empty without a file
  std::vector<std::string> warnings{};  ///< those of the IMU samples (ImuLog)
};

/// Reads a folder. Throws files::IoError that names file, line, column and value, also if imu.csv has no
/// sample.
AttitudeLog read_attitude_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address = {});

std::vector<TimeSpan> read_movement_csv(const std::filesystem::path& file);

}  // namespace sonopose::recording
