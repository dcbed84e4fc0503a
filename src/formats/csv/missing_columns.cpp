#include "csv/missing_columns.hpp"

#include "csv/column.hpp"
#include "csv/column_units.hpp"
#include "csv/units.hpp"

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <utility>

namespace sonopose::csv {
namespace {

std::string text_about_missing(const std::string& where, const std::vector<std::string_view>& columns,
                               std::string_view header) {
  constexpr std::size_t max_header_bytes = 200;
  std::string text = where + ": the header has no column ";
  for (const std::string_view column : columns) {
    if (column != columns.front()) text += ", ";
    text.append("\"").append(column).append("\"");
  }
  text.append(": \"").append(header.substr(0, max_header_bytes));
  return text.append(header.size() > max_header_bytes ? "…\"" : "\"");
}

bool has_any_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(words, [text](std::string_view word) { return text.find(word) != text.npos; });
}

/// True for the name of a time: `Zeit`, `utc`, `ms`, `t_us`.
bool is_name_of_time(std::string_view name) {
  const Column column = column_of(name);
  if (column.unit && unit_factor(*column.unit, "s")) return true;
  const std::string lower = lower_case(column.name);
  return unit_factor(lower, "s").has_value() || has_any_of(lower, {"time", "zeit", "stamp", "clock", "epoch",
                                                                   "date", "sec", "tick", "utc", "moment"});
}

/// True for the name of a quantity that no column has.
bool is_other_quantity(std::string_view name) {
  return !is_name_of_time(name) && has_any_of(lower_case(name), {"temp", "press", "hum", "batt", "volt",
                                                                 "rssi", "note", "status", "count"});
}

/// The unknown names that a column can be: names of times for a time, those that end in its axis for an axis,
/// or else all that do not name another quantity.
MissingColumn with_candidates(std::string_view column, const std::vector<std::string>& unknown) {
  constexpr std::size_t max_candidates = 5;
  MissingColumn missing{std::string(column_of(column).name), {}};
  std::vector<std::string> possible = unknown;
  std::erase_if(possible, [](const std::string& name) {
    return parse_number(name).has_value() || is_other_quantity(column_of(name).name);
  });
  const bool is_time = is_name_of_time(column);
  const auto fits = [&](const std::string& candidate) {
    const std::string_view name = column_of(candidate).name;
    return is_time ? is_name_of_time(candidate)
                   : !name.empty() && lower_case(name).back() == lower_case(missing.column).back();
  };
  std::vector<std::string>& found = missing.candidates;
  std::ranges::copy_if(possible, std::back_inserter(found), fits);
  if (found.empty()) found = std::move(possible);
  found.resize(std::min(found.size(), max_candidates));
  return missing;
}

}  // namespace

MissingColumns::MissingColumns(const std::string& where, const std::vector<std::string_view>& columns,
                               std::string_view header, const std::vector<std::string>& unknown)
    : files::IoError(text_about_missing(where, columns, header)) {
  for (const std::string_view column : columns) columns_.push_back(with_candidates(column, unknown));
}

MissingColumns::MissingColumns(const MissingColumns& one, const MissingColumns& other)
    : files::IoError(std::string(one.what()) + "; " + other.what()), columns_(one.columns_) {
  columns_.insert(columns_.end(), other.columns_.begin(), other.columns_.end());
}

NoNames::NoNames(const std::string& where, const std::vector<std::string_view>& columns,
                 std::string_view header)
    : files::IoError(text_about_missing(where, columns, header) + ": numbers instead of names") {}

}  // namespace sonopose::csv
