#pragma once
/// \file
/// The table of the screen: one row per beacon, in as many columns as fit.

#include "observation/beacon_observer.hpp"
#include "terminal/text.hpp"
#include <sonopose/text/columns_of.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace sonopose::monitor {

using text::columns_of;

/// The first columns of a UTF-8 text, with "…" at the end if it was longer. Control characters become "?".
std::string fitted(std::string_view text, std::size_t columns);

/// Titles of the columns that fit. The status is last and gets the remaining width.
terminal::Row table_heading(std::size_t columns);

/// Row of one beacon under a table_heading of the same width.
terminal::Row table_row(const observation::BeaconView& view, std::size_t columns, bool selected);

}  // namespace sonopose::monitor
