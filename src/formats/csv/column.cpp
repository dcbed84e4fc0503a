#include "csv/column.hpp"

#include "csv/cells.hpp"
#include "csv/column_units.hpp"

#include <algorithm>
#include <cctype>

namespace sonopose::csv {
namespace {

/// The place of the bracket that opens what the text ends with: 6 in `w_x (m/(s))`.
std::size_t last_bracket(std::string_view text) {
  int depth = 0;
  for (std::size_t place = text.size(); place-- > 0;) {
    if (text[place] == ']' || text[place] == ')') ++depth;
    if (text[place] == '[' || text[place] == '(') --depth;
    if (depth <= 0) return depth == 0 && place + 1 < text.size() ? place : std::string_view::npos;
  }
  return std::string_view::npos;
}

/// The axis of `gyro[0]`, `gyro[1]` and `gyro[2]`; empty for other names, and for quaternions, whose order is
/// not known.
std::string_view axis_of_element(const std::vector<std::string>& names, std::string_view name) {
  const std::size_t open = name.rfind('[');
  if (open == std::string_view::npos || open + 3 != name.size() || name.back() != ']') return {};
  const auto has_element = [&](char index) {
    const std::string element = std::string(name.substr(0, open + 1)) + index + "]";
    return std::ranges::find(names, element) != names.end();
  };
  const auto axis = static_cast<std::size_t>(name[open + 1] - '0');
  constexpr std::string_view axes = "xyz";
  if (axis >= axes.size() || !has_element('0') || !has_element('2') || has_element('3')) return {};
  return axes.substr(axis, 1);
}

}  // namespace

Column column_of(std::string_view cell) {
  Column bracketed{cell};
  for (std::size_t open = last_bracket(cell); open != std::string_view::npos; open = last_bracket(cell)) {
    const std::string_view content = trimmed(cell.substr(open + 1, cell.size() - open - 2));
    cell = bracketed.name = trimmed(cell.substr(0, open));
    if (!bracketed.unit || (!is_unit(*bracketed.unit) && is_unit(content))) bracketed.unit = content;
  }
  if (bracketed.unit) return bracketed;
  const std::size_t last = cell.find_last_of("_ ");
  if (last == std::string_view::npos || last == 0) return {cell};
  for (const std::size_t separator : {cell.find_last_of("_ ", last - 1), last}) {
    if (separator == std::string_view::npos || separator == 0) continue;
    const std::string_view end = cell.substr(separator + 1);
    if (!end.empty() && end != "1" && end != "-" && is_unit(end)) return {cell.substr(0, separator), end};
  }
  return {cell};
}

Column column_in(const std::vector<std::string>& header, std::string_view cell) {
  const std::string_view axis = axis_of_element(header, cell);
  Column column = column_of(axis.empty() ? cell : cell.substr(0, cell.rfind('[')));
  column.axis = axis;
  return column;
}

std::string lower_case(std::string_view text) {
  std::string lower;
  for (const char c : text) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

}  // namespace sonopose::csv
