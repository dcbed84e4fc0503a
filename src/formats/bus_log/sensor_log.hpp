#pragma once
/// \file
/// Reads the inputs of the fusion from any recording: a sensor-log folder, or an MCAP file of the bus.

#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::bus_log {

/// Returns true for a file, false for a log folder.
bool is_file(const std::filesystem::path& log);

/// Returns true for a file that begins like MCAP.
bool is_mcap(const std::filesystem::path& log);

/// Reads a folder like recording::read_sensor_log. Reads a file as MCAP if it begins so, else as a CSV log of
/// the vendor's Dashboard (dashboard_log.hpp). A file with several beacons needs an address.
///
/// The events of an MCAP file follow their sequence numbers on the bus, as in the fusion's collator, and are
/// renumbered from 1. Missing or damaged parts are described in `warnings` and in the log of the process.
/// Throws files::IoError that names the file and the fault; for several beacons, it lists their addresses.
recording::SensorLog read_sensor_log(const std::filesystem::path& log,
                                     std::optional<BeaconAddress> address = {});

/// The file with the IMU samples of a recording, for error messages: imu.csv of a folder, or the file itself.
std::filesystem::path imu_source(const std::filesystem::path& log);

std::vector<ImuSample> read_imu_log(const std::filesystem::path& log,
                                    std::optional<BeaconAddress> address = {});

}  // namespace sonopose::bus_log
