#pragma once
/// \file
/// The page of one beacon, with everything known about it.

#include "observation/beacon_observer.hpp"
#include "terminal/text.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace sonopose::monitor {

/// All lines of the page, of at most this many columns. Longer problems and warnings are wrapped.
std::vector<terminal::Row> page_of(const observation::BeaconView& view,
                                   const std::vector<std::string>& warnings, std::size_t columns);

/// Warnings as lines of at most this many columns.
std::vector<terminal::Row> wrapped(const std::vector<std::string>& warnings, std::size_t columns);

}  // namespace sonopose::monitor
