#pragma once
/// \file
/// The table of the screen: a row for each beacon, in as many columns as fit.

#include "observation/beacon_observer.hpp"
#include "terminal/text.hpp"
#include <sonopose/text/columns_of.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace sonopose::monitor {

using text::columns_of;

/// The first columns of a UTF-8 text; "…" at the end if it was longer. Control characters become "?".
std::string fitted(std::string_view text, std::size_t columns);

/// The titles of the columns that fit. The status is the last column and gets what is left.
terminal::Line table_heading(std::size_t columns);

/// The row of one beacon under table_heading of the same width.
terminal::Line table_row(const observation::BeaconView& view, std::size_t columns, bool selected);

}  // namespace sonopose::monitor
