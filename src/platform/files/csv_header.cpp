#include "files/csv_header.hpp"

#include "files/column_units.hpp"
#include "files/error.hpp"
#include "files/units.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

namespace sonopose::files {

namespace {

/// A cell of a header.
struct Column {
  std::string_view name;
  std::optional<std::string_view> unit{};
  std::string_view axis{};  ///< of an element of an array
};

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

/// Splits `x [mm]`, `x (mm)`, `x_mm`, `x mm` or `a_x_m_s2`. Other brackets beside that of a unit are notes.
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

/// Splits a cell of a header; three elements of an array are axes.
Column column_in(const std::vector<std::string>& header, std::string_view cell) {
  const std::string_view axis = axis_of_element(header, cell);
  Column column = column_of(axis.empty() ? cell : cell.substr(0, cell.rfind('[')));
  column.axis = axis;
  return column;
}

/// True for two axes of a vector, such as `w_x [rad s^-1]` and `w_y [rad s^-1]`. Times may each have their
/// own unit.
bool is_vector(std::string_view one, std::string_view other) {
  const std::string_view first = column_of(one).name;
  const std::string_view second = column_of(other).name;
  return first.size() == second.size() &&
         first.substr(0, first.size() - 1) == second.substr(0, second.size() - 1);
}

std::string lower_case(std::string_view text) {
  std::string lower;
  for (const char c : text) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

bool is_axis(char c) {
  return std::string_view("wxyz").find(c) != std::string_view::npos;
}

std::string with_synonym(const std::string& name, std::span<const ColumnSynonym> synonyms) {
  const bool has_axis = !name.empty() && is_axis(name.back());
  for (const ColumnSynonym& synonym : synonyms) {
    std::string_view searched = synonym.name;
    if (!searched.ends_with('*')) {
      if (searched == name) return std::string(synonym.own);
      continue;
    }
    searched.remove_suffix(1);
    if (!has_axis || std::string_view(name).substr(0, name.size() - 1) != searched) continue;
    return std::string(synonym.own.substr(0, synonym.own.size() - 1)) + name.back();
  }
  constexpr std::size_t min_size = 4;  // xacc; shorter names may mean something else
  if (name.size() >= min_size && is_axis(name.front()) && !has_axis)
    return with_synonym(name.substr(1) + name.front(), synonyms);
  return name;
}

/// The name without case, separators, EuRoC's frames and the prefix of rostopic, with the layout's word for a
/// synonym.
std::string comparable(std::string_view name, std::span<const ColumnSynonym> synonyms) {
  constexpr std::string_view separators = "_. -/";
  std::string text;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of(separators), name.size());
    const std::string_view word = name.substr(0, end);
    if (word != "RS" && word != "S" && word != "R" && word != "field") text += lower_case(word);
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return with_synonym(text, synonyms);
}

std::optional<std::size_t> find_column(const CsvLayout& layout, std::string_view name) {
  const std::string wanted = comparable(name, layout.synonyms);
  for (std::size_t column = 0; column < layout.columns.size(); ++column) {
    if (comparable(column_of(layout.columns[column]).name, layout.synonyms) == wanted) return column;
  }
  return std::nullopt;
}

char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
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
    : IoError(text_about_missing(where, columns, header)) {
  for (const std::string_view column : columns) columns_.push_back(with_candidates(column, unknown));
}

MissingColumns::MissingColumns(const MissingColumns& one, const MissingColumns& other)
    : IoError(std::string(one.what()) + "; " + other.what()), columns_(one.columns_) {
  columns_.insert(columns_.end(), other.columns_.begin(), other.columns_.end());
}

const std::pair<const std::string, std::string>* ColumnNames::find(const std::filesystem::path& file,
                                                                   const std::string& name) const {
  for (const std::string& key : {file.string() + ":" + name, file.filename().string() + ":" + name, name}) {
    if (const auto entry = own_by_given.find(key); entry != own_by_given.end()) return &*entry;
  }
  return nullptr;
}

std::string ColumnNames::option(std::size_t reader, const std::string& column, std::string_view unit) const {
  const std::string& name = columns_by_reader.at(reader).at(column);
  bool is_in_other = false;
  for (std::size_t other = 0; other < file_by_reader.size(); ++other) {
    if (file_by_reader[other] == file_by_reader[reader]) continue;
    is_in_other |= std::ranges::any_of(columns_by_reader[other],
                                       [&name](const auto& entry) { return entry.second == name; });
  }
  std::string text = "--column \"";
  if (is_in_other) text += file_by_reader[reader].filename().string() + ":";
  return text.append(column).append(" [").append(unit).append("]=").append(name) + "\"";
}

bool has_column(const CsvLayout& layout, std::string_view name) {
  return find_column(layout, column_of(name).name).has_value();
}

bool is_line_of_units(std::string_view names, std::string_view line) {
  for (std::string_view* const each : {&names, &line}) {
    if (each->starts_with('#')) each->remove_prefix(1);
  }
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

CsvHeader::CsvHeader(const CsvLayout& layout, std::string_view line, const std::string& where,
                     std::string_view units) {
  if (line.starts_with('#')) line.remove_prefix(1);
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
  std::vector<std::string_view> not_found;
  for (std::size_t column = 0; column < layout.required_columns; ++column) {
    if (places_[column] == missing) {
      not_found.push_back(layout.columns[column]);
    } else {
      required_width_ = std::max(required_width_, places_[column] + 1);
    }
  }
  if (!not_found.empty()) {
    const auto numbers =
        std::ranges::count_if(names_, [](const std::string& name) { return parse_number(name).has_value(); });
    if (2 * static_cast<std::size_t>(numbers) > names_.size())
      throw NoNames(text_about_missing(where, not_found, line) + ": numbers instead of names");
    throw MissingColumns(where, not_found, line, unknown_);
  }
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
void CsvHeader::add_name(std::string_view cell) {
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
void CsvHeader::rename(ColumnNames& given, const std::filesystem::path& file, const std::string& where) {
  for (std::string& name : names_) {
    const auto* const found = given.find(file, name);
    if (found == nullptr) continue;
    given.found.insert(found->first);
    const auto unit = column_in(names_in_file_, name).unit;
    const auto given_unit = column_of(found->second).unit;
    if (unit && given_unit && *unit != *given_unit && is_unit(*unit)) {
      std::string text = where + ": column \"";
      text.append(name).append("\" names the unit \"").append(*unit);
      throw IoError(text.append("\", but it is given as \"").append(found->second).append("\""));
    }
    name = found->second + (unit && !given_unit ? " [" + std::string(*unit) + "]" : "");
  }
}

/// Appends the units of a line to names without one.
void CsvHeader::add_units(std::string_view units) {
  if (units.empty()) return;
  if (units.starts_with('#')) units.remove_prefix(1);
  split_cells(separator_, units, [this](std::size_t place, std::string_view cell) {
    const std::string_view unit = without_brackets(cell);
    if (place >= names_.size() || unit.empty() || unit == "-") return;
    if (!column_in(names_in_file_, names_[place]).unit) names_[place].append(" [").append(unit) += ']';
  });
}

/// Finds the two columns of a time in whole seconds and nanoseconds. They count for more than another time,
/// which is that of a recorder, but not for more than a name that the user gave.
void CsvHeader::join_seconds(const CsvLayout& layout) {
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

/// Refuses a vector, or two times, of which only a part names another unit than that of the layout, and a
/// vector with mixed units.
void CsvHeader::require_units(const CsvLayout& layout, const std::string& where) const {
  for (std::size_t column = 1; column < layout.columns.size(); ++column) {
    for (const auto& [one, other] : {std::pair(column - 1, column), std::pair(column, column - 1)}) {
      if (places_[one] == missing || places_[other] == missing || own_units_[one] != own_units_[other])
        continue;
      if (is_vector(layout.columns[one], layout.columns[other]) && has_unit_[one] && has_unit_[other] &&
          factors_[one] != factors_[other]) {
        throw IoError(where + ": column " + std::to_string(places_[one] + 1) + " (" + name(one) +
                      ") has another unit than column " + std::to_string(places_[other] + 1) + " (" +
                      name(other) + ")");
      }
      if (factors_[one] == 1.0L || has_unit_[other]) continue;
      throw IoError(where + ": column " + std::to_string(places_[other] + 1) + " (" + name(other) +
                    ") names no unit, but column " + std::to_string(places_[one] + 1) + " (" + name(one) +
                    ") does");
    }
  }
}

/// Finds the column of a name, also at the end of a path (`pose.position.x`), or of a unit of time as a name.
/// Prefers the name that the user gave, then that with the fewest parts left out.
void CsvHeader::match(const CsvLayout& layout, std::size_t place, const std::string& where) {
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
    throw IoError(where + ": column " + std::to_string(place + 1) + " (" + text + "): column " +
                  std::to_string(places_[*column] + 1) + " (" + names_[places_[*column]] + ") is the same");
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

void CsvHeader::set_unit(const CsvLayout& layout, std::size_t column, std::optional<std::string_view> unit,
                         const std::string& where) {
  const auto own_unit = column_of(layout.columns[column]).unit;
  has_unit_[column] = unit.has_value();
  own_units_[column] = own_unit.value_or("");
  factors_[column] = 1.0L;
  if (!unit || !own_unit) return;
  const auto factor = unit_factor(*unit, *own_unit);
  if (!factor) {
    throw IoError(where + ": column " + std::to_string(places_[column] + 1) + " (" + name(column) +
                  "): the unit \"" + std::string(*unit) + "\" is unknown here; expected one of " +
                  units_like(*own_unit) +
                  (layout.given_names == nullptr ? ""
                                                 : "; if it is a note, give the unit: --column \"" +
                                                       std::string(layout.columns[column]) + "=" +
                                                       names_in_file_[places_[column]] + "\""));
  }
  factors_[column] = *factor;
}

}  // namespace sonopose::files
