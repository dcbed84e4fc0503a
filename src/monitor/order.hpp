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

/// Whether a pose of the beacon has arrived.
bool has_pose(const observation::BeaconView& view);

/// The RMS error of the position against the truth if that is known, otherwise its standard deviation (3D),
/// m. NaN: unknown.
double error_m(const observation::BeaconView& view);

enum class Order : std::uint8_t { worst, address, error, trust, latency };

/// In the order of the values.
inline constexpr std::array<std::string_view, 5> order_words{"worst", "address", "error", "trust", "latency"};

/// The worst first, by severity, then by error; or by address; or the largest error, the least trust, or the
/// largest latency (99th percentile) first. What is unknown comes last, and the rest is by address.
void sort(std::vector<observation::BeaconView>& views, Order order);

}  // namespace sonopose::monitor
