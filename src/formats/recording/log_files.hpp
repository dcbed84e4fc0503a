#pragma once
/// \file
/// Reads the single files of a sensor-log folder (log_folder.hpp).

#include "recording/log_columns.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace sonopose::recording {

/// A measurement of the vehicle's odometer.
struct WheelSpeed {
  TimeNs time_ns = 0;
  double speed_mps = 0;  ///< speed; negative: backwards
};

/// The IMU samples of a table.
struct ImuTable {
  std::vector<ImuSample> samples;
  std::size_t rows_without_values = 0;  ///< rows that lack the time or a value, which are left out
  std::size_t incomplete_rows = 0;      ///< those of them that have a part of the vectors
};

/// Reads a file, in its order and without sequence numbers. This and the others throw files::IoError. Only a
/// layout with given names leaves rows out.
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
