#pragma once
/// \file
/// The monitor's output as text: a table, and the summary of a run.

#include "observation/beacon_observer.hpp"

#include <string>
#include <vector>

namespace sonopose::monitor {

/// A table of poses with a row per beacon, a table of latency segments, what the fusions have estimated, a
/// line for each process that counted problems, and a line for each warning. Each line ends with a newline.
std::string table_of(const std::vector<observation::BeaconView>& views,
                     const std::vector<std::string>& warnings = {});

/// A paragraph per beacon: rates, latency and its segments, position error, losses.
std::string summary_of(const std::vector<observation::BeaconView>& views);

}  // namespace sonopose::monitor
