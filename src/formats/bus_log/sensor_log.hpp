#pragma once
/// \file
/// Reads the inputs of the fusion from any recording: a sensor-log folder, or files of the bus or of rosbag2.

#include "recording/attitude_log.hpp"
#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::bus_log {

/// Reads a log folder like recording::read_sensor_log, and the MCAP files of another folder as one recording.
/// Reads a file as MCAP or SQLite if it begins so, else as a CSV log of the vendor's Dashboard
/// (dashboard_log.hpp). A recording of several beacons needs an address. One of rosbag2 has the inputs of
/// ros2::bag::chosen_topics(); without any, it is read unless it has inputs of the bus.
///
/// The events of MCAP files follow their sequence numbers on the bus, as in the fusion's collator, and are
/// renumbered from 1. Missing or damaged parts are described in `warnings` and in the log of the process.
/// Throws files::IoError that names the file and the fault; for several beacons, it lists their addresses.
recording::SensorLog read_sensor_log(const std::filesystem::path& log,
                                     std::optional<BeaconAddress> address = {});

/// Reads several MCAP files, or folders of them, as one recording.
recording::SensorLog read_sensor_log(const std::vector<std::filesystem::path>& paths,
                                     std::optional<BeaconAddress> address = {});

/// The file with the IMU samples of a recording, for error messages: imu.csv of a log folder, or the
/// recording.
std::filesystem::path imu_source(const std::filesystem::path& log);

std::vector<ImuSample> read_imu_log(const std::filesystem::path& log,
                                    std::optional<BeaconAddress> address = {});

/// Samples and truth for an attitude filter, without movements if it is no log folder.
recording::AttitudeLog read_attitude_log(const std::filesystem::path& log,
                                         std::optional<BeaconAddress> address = {});

}  // namespace sonopose::bus_log
