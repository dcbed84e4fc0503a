#pragma once
/// \file
/// Converts a recording to the form that the page plays.

#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::web::recording {

/// One JSON object: {"begin", "duration", "beacons": [{"address", "rows", "poses", "truth", "fixes",
/// "status"}], "stationary", "events"}. Each of the last four of a beacon has columns of numbers, named in
/// web/live/rows.hpp and document.cpp. An MCAP file with poses shows the poses of all its beacons. A
/// sensor-log folder, or a file without poses, is fused with the default settings; a file with several
/// beacons then needs an address. Long recordings are thinned. Throws files::IoError, std::invalid_argument.
std::string recording_json(const std::filesystem::path& recording, std::optional<BeaconAddress> beacon = {});

}  // namespace sonopose::web::recording
