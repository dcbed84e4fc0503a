#pragma once
/// \file
/// Reads CSV logs of the vendor's Dashboard as recordings.

#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>

namespace sonopose::bus_log {

/// Reads one beacon of a Dashboard log. Unreadable lines are left out and counted in `warnings`. Throws
/// files::IoError if no line is of such a log, and, with a list of the addresses, if the log has several
/// beacons.
recording::SensorLog read_dashboard_log(const std::filesystem::path& file,
                                        std::optional<BeaconAddress> address);

}  // namespace sonopose::bus_log
