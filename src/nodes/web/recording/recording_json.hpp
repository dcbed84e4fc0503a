#pragma once
/// \file
/// Converts a recording to the form that the page plays.

#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::web::recording {

/// One JSON object: {"begin", "duration", "beacons": [{"address", "rows", "poses", "truth", "fixes",
/// "status"}], "stationary", "events"}. Each of the last four of a beacon has columns of numbers, named in
/// web/live/rows.hpp and document.cpp. MCAP files with poses show the poses of all their beacons. A
/// sensor-log folder, or a recording without poses, is fused with the default settings; one of several
/// beacons then needs an address. Long recordings are thinned. Throws files::IoError, std::invalid_argument.
std::string recording_json(const std::vector<std::filesystem::path>& recording,
                           std::optional<BeaconAddress> beacon = {});

}  // namespace sonopose::web::recording
