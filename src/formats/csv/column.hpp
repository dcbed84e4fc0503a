#pragma once
/// \file
/// Parses one cell of a header: name, unit and axis. Private to this folder.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::csv {

/// A cell of a header.
struct Column {
  std::string_view name;
  std::optional<std::string_view> unit{};
  std::string_view axis{};  ///< axis of an element of an array
};

/// Splits `x [mm]`, `x (mm)`, `x_mm`, `x mm` or `a_x_m_s2`. Other brackets beside that of a unit are notes.
Column column_of(std::string_view cell);

/// Splits a cell of a header; three elements of an array are axes.
Column column_in(const std::vector<std::string>& header, std::string_view cell);

std::string lower_case(std::string_view text);

}  // namespace sonopose::csv
