#pragma once
/// \file
/// The columns that a file can have, and the names by which a header may call them.

#include "csv/column_names.hpp"
#include <sonopose/samples/time.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::csv {

/// Another name of a column. A final `*` stands for an axis: `gyro*` for `gyro_x`, `gyro_y`, ….
struct ColumnSynonym {
  std::string_view name;  ///< lower case, without separators
  std::string_view own;   ///< the same for the name in the layout
};

/// The columns that a file can have.
struct Layout {
  std::span<const std::string_view> columns;  ///< names with units: `x [m]`
  std::size_t required_columns = 0;           ///< number of those, from the first, that a file must have
  std::span<const ColumnSynonym> synonyms{};
  ColumnNames* given_names = nullptr;  ///< these replace names in the header, and are marked as found
  TimeNs time_offset_ns = 0;           ///< added to each time
  std::string file{};                  ///< set by the reader
  std::string last_value{};            ///< only rows with this in the last column; empty: all rows
};

/// Returns the index of the column of this name, which has no unit. Compares names as described for Header.
std::optional<std::size_t> find_column(const Layout& layout, std::string_view name);

/// Returns true if the layout has a column of this name, with or without unit.
bool has_column(const Layout& layout, std::string_view name);

}  // namespace sonopose::csv
