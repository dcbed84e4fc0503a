#pragma once
/// \file
/// The page of one beacon: everything that is known about it.

#include "observation/beacon_observer.hpp"
#include "terminal/text.hpp"

#include <cstddef>
#include <vector>

namespace sonopose::monitor {

/// As many lines as it needs, of at most this many columns.
std::vector<terminal::Line> page_of(const observation::BeaconView& view, std::size_t columns);

}  // namespace sonopose::monitor
