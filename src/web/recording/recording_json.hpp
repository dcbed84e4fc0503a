#pragma once
/// \file
/// A recording as the page plays it.

#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::web::recording {

/// One JSON object: {"begin", "duration", "beacons": [{"address", "rows", "poses", "truth", "fixes",
/// "status"}], "stationary", "events"}, in which each of the four has columns of numbers, named in
/// web/live/rows.hpp and document.cpp. An MCAP file with poses shows those, of all beacons. A sensor-log
/// folder, and a file without poses, shows what the fusion makes of it with the default settings; a file with
/// several beacons then needs an address. Long recordings are thinned. Throws files::IoError,
/// std::invalid_argument.
std::string recording_json(const std::filesystem::path& recording, std::optional<BeaconAddress> beacon = {});

}  // namespace sonopose::web::recording
