#include "csv/header.hpp"

#include "csv/cells.hpp"
#include "csv/column.hpp"
#include "csv/column_units.hpp"
#include "csv/missing_columns.hpp"
#include "csv/units.hpp"
#include "files/error.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <tuple>
#include <utility>

namespace sonopose::csv {
namespace {

/// True for two axes of a vector, such as `w_x [rad s^-1]` and `w_y [rad s^-1]`. Times may each have their
/// own unit.
bool is_vector(std::string_view one, std::string_view other) {
  const std::string_view first = column_of(one).name;
  const std::string_view second = column_of(other).name;
  return first.size() == second.size() &&
         first.substr(0, first.size() - 1) == second.substr(0, second.size() - 1);
}

/// A text without brackets around it.
std::string_view without_brackets(std::string_view text) {
  const bool is_bracketed = text.size() > 1 && (text.starts_with('[') || text.starts_with('(')) &&
                            (text.ends_with(']') || text.ends_with(')'));
  return is_bracketed ? trimmed(text.substr(1, text.size() - 2)) : text;
}

/// The path before the last part of a name such as `header.stamp.sec`, with its separator, if that part is
/// one of the words.
std::optional<std::string> path_before(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::size_t last = name.find_last_of("./%_") + 1;  // 0 without a path
  if (std::ranges::find(words, lower_case(name.substr(last))) == words.end()) return std::nullopt;
  return std::string(name.substr(0, last));
}

}  // namespace

bool is_line_of_units(std::string_view names, std::string_view line) {
  names = unmarked(names);
  line = unmarked(line);
  const char separator = separator_of(names);
  bool has_unit = false;
  bool has_number = false;
  const std::size_t cells = split_cells(separator, line, [&](std::size_t, std::string_view cell) {
    const std::string_view unit = without_brackets(cell);
    if (unit.empty() || unit == "-" || unit == "1") return;
    has_unit |= is_unit(unit);
    has_number |= parse_number(unit).has_value();
  });
  return has_unit && !has_number && cells == split_cells(separator, names, [](auto, auto) {});
}

Header::Header(const Layout& layout, std::string_view line, const std::string& where,
               std::string_view units) {
  line = unmarked(line);
  separator_ = separator_of(line);
  split_cells(separator_, line, [this](std::size_t, std::string_view cell) { add_name(cell); });
  names_in_file_ = names_;
  if (layout.given_names != nullptr) rename(*layout.given_names, layout.file, where);
  add_units(units);
  join_seconds(layout);
  places_.fill(missing);
  factors_.fill(1.0L);
  ranks_.fill(missing);
  for (std::size_t place = 0; place < names_.size(); ++place) match(layout, place, where);
  require_units(layout, where);
  require_columns(layout, line, where);
  if (separator_ == ' ') required_width_ = names_.size();  // between spaces no cell can be empty
  if (layout.given_names == nullptr) return;
  layout.given_names->file_by_reader.emplace_back(layout.file);
  auto& columns = layout.given_names->columns_by_reader.emplace_back();
  for (std::size_t column = 0; column < layout.columns.size(); ++column) {
    if (places_[column] == missing) continue;
    columns.emplace(column_of(layout.columns[column]).name, names_in_file_[places_[column]]);
  }
}

/// Adds a name. Where spaces separate names, a unit in brackets belongs to the name before it.
void Header::add_name(std::string_view cell) {
  const bool is_unit_of_last =
      separator_ == ' ' && !names_.empty() && (cell.starts_with('[') || cell.starts_with('(') || is_open_);
  if (is_unit_of_last) {
    names_.back() += " " + std::string(cell);
  } else {
    names_.emplace_back(cell);
  }
  const std::size_t bracket = names_.back().find_first_of("[(");
  is_open_ = bracket != std::string::npos && names_.back().find_first_of("])") == std::string::npos;
}

/// A file has the same columns for all its readers, so a found name may be of another layout. A column keeps
/// its unit unless the given name has one.
void Header::rename(ColumnNames& given, const std::filesystem::path& file, const std::string& where) {
  for (std::string& name : names_) {
    const auto* const found = given.find(file, name);
    if (found == nullptr) continue;
    given.found.insert(found->first);
    const auto unit = column_in(names_in_file_, name).unit;
    const auto given_unit = column_of(found->second).unit;
    if (unit && given_unit && *unit != *given_unit && is_unit(*unit)) {
      std::string text = where + ": column \"";
      text.append(name).append("\" names the unit \"").append(*unit);
      throw files::IoError(text.append("\", but it is given as \"").append(found->second).append("\""));
    }
    name = found->second + (unit && !given_unit ? " [" + std::string(*unit) + "]" : "");
  }
}

/// Appends the units of a line to names without one.
void Header::add_units(std::string_view units) {
  if (units.empty()) return;
  units = unmarked(units);
  split_cells(separator_, units, [this](std::size_t place, std::string_view cell) {
    const std::string_view unit = without_brackets(cell);
    if (place >= names_.size() || unit.empty() || unit == "-") return;
    if (!column_in(names_in_file_, names_[place]).unit) names_[place].append(" [").append(unit) += ']';
  });
}

/// Finds the two columns of a time in whole seconds and nanoseconds. They count for more than another time,
/// which is that of a recorder, but not for more than a name that the user gave.
void Header::join_seconds(const Layout& layout) {
  if (layout.given_names != nullptr) {
    for (const std::string& name : names_in_file_) {
      const auto* const given = layout.given_names->find(layout.file, name);
      if (given != nullptr && find_column(layout, column_of(given->second).name) == 0) return;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t place = 0; place < names_.size(); ++place) {
    const auto path = path_before(names_[place], {"sec", "secs"});
    for (std::size_t other = 0; path && other < names_.size(); ++other) {
      if (path_before(names_[other], {"nanosec", "nsec", "nsecs"}) == path) pairs.emplace_back(place, other);
    }
  }
  if (pairs.size() != 1) return;
  std::tie(seconds_place_, nanoseconds_place_) = pairs.front();
  names_[seconds_place_] = "time [s]";
}

/// Finds the width that a row must have. Throws if a required column is missing.
void Header::require_columns(const Layout& layout, std::string_view line, const std::string& where) {
  std::vector<std::string_view> not_found;
  for (std::size_t column = 0; column < layout.required_columns; ++column) {
    if (places_[column] == missing) {
      not_found.push_back(layout.columns[column]);
    } else {
      required_width_ = std::max(required_width_, places_[column] + 1);
    }
  }
  if (not_found.empty()) return;
  const auto numbers =
      std::ranges::count_if(names_, [](const std::string& name) { return parse_number(name).has_value(); });
  if (2 * static_cast<std::size_t>(numbers) > names_.size()) throw NoNames(where, not_found, line);
  throw MissingColumns(where, not_found, line, unknown_);
}

/// Refuses a vector, or two times, of which only a part names another unit than that of the layout, and a
/// vector with mixed units.
void Header::require_units(const Layout& layout, const std::string& where) const {
  for (std::size_t column = 1; column < layout.columns.size(); ++column) {
    for (const auto& [one, other] : {std::pair(column - 1, column), std::pair(column, column - 1)}) {
      if (places_[one] == missing || places_[other] == missing || own_units_[one] != own_units_[other])
        continue;
      if (is_vector(layout.columns[one], layout.columns[other]) && has_unit_[one] && has_unit_[other] &&
          factors_[one] != factors_[other]) {
        throw files::IoError(where + ": column " + std::to_string(places_[one] + 1) + " (" + name(one) +
                             ") has another unit than column " + std::to_string(places_[other] + 1) + " (" +
                             name(other) + ")");
      }
      if (factors_[one] == 1.0L || has_unit_[other]) continue;
      throw files::IoError(where + ": column " + std::to_string(places_[other] + 1) + " (" + name(other) +
                           ") names no unit, but column " + std::to_string(places_[one] + 1) + " (" +
                           name(one) + ") does");
    }
  }
}

/// Finds the column of a name, also at the end of a path (`pose.position.x`), or of a unit of time as a name.
/// Prefers the name that the user gave, then that with the fewest parts left out.
void Header::match(const Layout& layout, std::size_t place, const std::string& where) {
  if (place == nanoseconds_place_) return;
  const std::string& text = names_[place];
  Column given = column_in(names_in_file_, text);
  std::string name(given.name);
  name += given.axis;
  std::optional<std::size_t> column = find_column(layout, name);
  const bool is_given = layout.given_names != nullptr &&
                        layout.given_names->find(layout.file, names_in_file_[place]) != nullptr;
  std::size_t rank = is_given || place == seconds_place_ ? 0 : 1;
  constexpr std::string_view path_separators = "./%";
  for (std::size_t end = name.find_first_of(path_separators); !column && end != std::string::npos;
       end = name.find_first_of(path_separators)) {
    name.erase(0, end + 1);
    ++rank;
    if (name.size() > 1) column = find_column(layout, name);  // one letter may be of anything
  }
  if (const std::string unit = lower_case(text); !column && unit.size() > 1 && unit_factor(unit, "s")) {
    name = unit;
    given.unit = name;
    column = find_column(layout, "time");
    ++rank;
  }
  if (column && rank == ranks_[*column]) {
    throw files::IoError(where + ": column " + std::to_string(place + 1) + " (" + text + "): column " +
                         std::to_string(places_[*column] + 1) + " (" + names_[places_[*column]] +
                         ") is the same");
  }
  if (!column || rank > ranks_[*column]) {
    unknown_.push_back(text);
    return;
  }
  if (places_[*column] != missing) unknown_.push_back(names_[places_[*column]]);
  places_[*column] = place;
  ranks_[*column] = rank;
  set_unit(layout, *column, given.unit, where);
}

void Header::set_unit(const Layout& layout, std::size_t column, std::optional<std::string_view> unit,
                      const std::string& where) {
  const auto own_unit = column_of(layout.columns[column]).unit;
  has_unit_[column] = unit.has_value();
  own_units_[column] = own_unit.value_or("");
  factors_[column] = 1.0L;
  if (!unit || !own_unit) return;
  const auto factor = unit_factor(*unit, *own_unit);
  if (!factor) {
    throw files::IoError(where + ": column " + std::to_string(places_[column] + 1) + " (" + name(column) +
                         "): the unit \"" + std::string(*unit) + "\" is unknown here; expected one of " +
                         units_like(*own_unit) +
                         (layout.given_names == nullptr ? ""
                                                        : "; if it is a note, give the unit: --column \"" +
                                                              std::string(layout.columns[column]) + "=" +
                                                              names_in_file_[places_[column]] + "\""));
  }
  factors_[column] = *factor;
}

}  // namespace sonopose::csv
