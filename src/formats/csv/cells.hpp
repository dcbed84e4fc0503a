#pragma once
/// \file
/// Splits a line into cells.

#include <cstddef>
#include <string_view>

namespace sonopose::csv {

/// A text without spaces and tabs at its ends.
inline std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// True for a line that begins as a comment does: with `#`, or with `%` as in MATLAB.
inline bool is_marked(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%');
}

/// A line without the mark of a comment. Without a space, `%` is part of a name, such as `%time` of ROS.
inline std::string_view unmarked(std::string_view line) {
  if (line.starts_with('#') || line.starts_with("% ")) line.remove_prefix(1);
  return line;
}

/// Separator of the cells of a line.
inline char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

/// A text without quotation marks around it.
inline std::string_view unquoted(std::string_view text) {
  const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// Splits a line; calls `on_cell(index, cell)` for each cell, and returns their number.
template <class OnCell>
std::size_t split_cells(char separator, std::string_view line, const OnCell& on_cell) {
  line = trimmed(line);
  for (std::size_t index = 0;; ++index) {
    const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
    on_cell(index, unquoted(trimmed(line.substr(0, end))));
    if (end == std::string_view::npos) return index + 1;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line);
  }
}

}  // namespace sonopose::csv
