#pragma once
/// \file
/// Formats a BusSnapshot as JSON.

#include "observation/beacon_observer.hpp"

#include <string>
#include <vector>

namespace sonopose::observation::bus {

/// One object without a newline: {"time_ns", "beacons": [...], "warnings": [...]}. null: unknown.
std::string json_of(const std::vector<BeaconView>& views, const std::vector<std::string>& warnings,
                    TimeNs now_ns);

}  // namespace sonopose::observation::bus
