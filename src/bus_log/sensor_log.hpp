#pragma once
/// \file
/// The inputs of the fusion from a recording of any form: a sensor-log folder, or an MCAP file with what the
/// bus had.

#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::bus_log {

/// Whether it is a file and not a log folder.
bool is_file(const std::filesystem::path& log);

/// Whether it is a file that begins like MCAP.
bool is_mcap(const std::filesystem::path& log);

/// Reads a folder as recording::read_sensor_log does, and a file by its content: as MCAP if it begins so,
/// else as a CSV log of the vendor's Dashboard (dashboard_log.hpp). A file with several beacons needs an
/// address.
///
/// The events of an MCAP file are in the order of their numbers on the bus, as the fusion's collator makes
/// it, and are numbered again from 1. What is missing or damaged is in `warnings` and in the log of the
/// process. Throws files::IoError that names the file and what is wrong; for a file with several beacons, it
/// lists their addresses.
recording::SensorLog read_sensor_log(const std::filesystem::path& log,
                                     std::optional<BeaconAddress> address = {});

/// What has the IMU samples of a recording, for errors: imu.csv of a folder, or the file.
std::filesystem::path imu_source(const std::filesystem::path& log);

/// The IMU samples alone.
std::vector<ImuSample> read_imu_log(const std::filesystem::path& log,
                                    std::optional<BeaconAddress> address = {});

}  // namespace sonopose::bus_log
