#pragma once
/// \file
/// The monitor's words: a table, one JSON object, and the summary of a run.

#include "observation/beacon_view.hpp"

#include <string>
#include <vector>

namespace sonopose::monitor {

/// A header and a row per beacon, the same again for the segments of the poses' way, and a line for each process
/// that counted a breach of a promise; each ended by a newline.
std::string table_of(const std::vector<observation::BeaconView>& views);

/// {"time_ns": …, "beacons": [{…}]}, on one line without a newline. What is not known is null.
std::string json_of(const std::vector<observation::BeaconView>& views, TimeNs now_ns);

/// Some lines per beacon: rates, latency and its segments, error, losses.
std::string summary_of(const std::vector<observation::BeaconView>& views);

}  // namespace sonopose::monitor
