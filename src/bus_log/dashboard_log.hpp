#pragma once
/// \file
/// CSV logs of the vendor's Dashboard as recordings.

#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>

namespace sonopose::bus_log {

/// One beacon of such a log. Throws files::IoError, also if no line is of such a log; for a log of several
/// beacons it lists their addresses. Lines that cannot be read are left out and counted in `warnings`.
recording::SensorLog read_dashboard_log(const std::filesystem::path& file,
                                        std::optional<BeaconAddress> address);

}  // namespace sonopose::bus_log
