#pragma once
/// \file
/// Formats the fusions' estimates of the sensors, in at most 80 columns.

#include "observation/beacon_observer.hpp"

#include <string>
#include <vector>

namespace sonopose::monitor {

/// One line per estimated value, with unit and standard deviation, and a list of the values that are not
/// estimated. Empty if no beacon has an estimate. Each line ends with a newline.
std::string estimate_table_of(const std::vector<observation::BeaconView>& views);

}  // namespace sonopose::monitor
