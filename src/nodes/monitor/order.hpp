#pragma once
/// \file
/// The order of the beacons on the screen.

#include "observation/stream_state.hpp"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sonopose::monitor {

using observation::bad_severity;
using observation::severity_of;

/// True if a pose of the beacon has arrived.
bool has_pose(const observation::BeaconView& view);

/// RMS position error against the truth if known, otherwise the standard deviation (3D), m. NaN: unknown.
double error_m(const observation::BeaconView& view);

enum class Order : std::uint8_t { worst, address, error, trust, latency };

/// Names of the orders, in the order of the enumerators.
inline constexpr std::array<std::string_view, 5> order_words{"worst", "address", "error", "trust", "latency"};

/// Sorts by severity, then error (worst first); by address; or with the largest error, the least trust, or
/// the largest latency (99th percentile) first. Unknown values come last. Ties are sorted by address.
void sort(std::vector<observation::BeaconView>& views, Order order);

}  // namespace sonopose::monitor
