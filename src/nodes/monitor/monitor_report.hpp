#pragma once
/// \file
/// The monitor's output as text: a table, and the summary of a run.

#include "observation/beacon_observer.hpp"

#include <string>
#include <vector>

namespace sonopose::monitor {

/// A table of poses with one row per beacon, a table of latency segments, the fusions' estimates, one line
/// for each process with problems, and one line for each warning. Each line ends with a newline.
std::string table_of(const std::vector<observation::BeaconView>& views,
                     const std::vector<std::string>& warnings = {});

/// One paragraph per beacon: rates, latency and its segments, position error, losses.
std::string summary_of(const std::vector<observation::BeaconView>& views);

}  // namespace sonopose::monitor
