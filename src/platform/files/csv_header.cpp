#include "files/csv_header.hpp"

#include "files/column_units.hpp"
#include "files/error.hpp"
#include "files/units.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>
#include <utility>

namespace sonopose::files {

namespace {

/// A cell of a header.
struct Column {
  std::string_view name;
  std::optional<std::string_view> unit{};
};

/// Splits `x [mm]`, `x (mm)` or `x_mm`.
Column column_of(std::string_view cell) {
  const std::size_t open = cell.find_first_of("[(");
  if (open != std::string_view::npos && (cell.back() == ']' || cell.back() == ')')) {
    return {trimmed(cell.substr(0, open)), trimmed(cell.substr(open + 1, cell.size() - open - 2))};
  }
  const std::size_t last = cell.rfind('_');
  const std::string_view end = last == std::string_view::npos ? "" : cell.substr(last + 1);
  if (last > 0 && !end.empty() && end != "1" && end != "-" && is_unit(end))
    return {cell.substr(0, last), end};
  return {cell};
}

std::string with_synonym(const std::string& name, std::span<const ColumnSynonym> synonyms) {
  const bool has_axis = !name.empty() && std::string_view("wxyz").find(name.back()) != std::string_view::npos;
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
  return name;
}

/// The name without case, separators and EuRoC's frames, with the layout's word for a synonym.
std::string comparable(std::string_view name, std::span<const ColumnSynonym> synonyms) {
  constexpr std::string_view separators = "_. -/";
  std::string text;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of(separators), name.size());
    const std::string_view word = name.substr(0, end);
    if (word != "RS" && word != "S" && word != "R") {
      for (const char c : word) text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return with_synonym(text, synonyms);
}

char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

}  // namespace

namespace {
constexpr std::size_t max_header_bytes = 200;
constexpr std::size_t max_candidates = 5;
}  // namespace

MissingColumn::MissingColumn(const std::string& where, std::string_view column, std::string_view header,
                             const std::vector<std::string>& candidates)
    : IoError(where + ": the header has no column \"" + std::string(column) + "\": \"" +
              std::string(header.substr(0, max_header_bytes)) +
              (header.size() > max_header_bytes ? "…" : "") + "\""),
      column_(column_of(column).name) {
  const auto axis_of = [](std::string_view name) {
    return std::tolower(static_cast<unsigned char>(name.back()));
  };
  std::ranges::copy_if(candidates, std::back_inserter(candidates_), [&](const std::string& candidate) {
    const std::string_view name = column_of(candidate).name;
    return !name.empty() && axis_of(name) == axis_of(column_);
  });
  if (candidates_.empty()) candidates_ = candidates;
  std::erase_if(candidates_, [](const std::string& name) { return parse_number(name).has_value(); });
  candidates_.resize(std::min(candidates_.size(), max_candidates));
}

CsvHeader::CsvHeader(const CsvLayout& layout, std::string_view line, const std::string& where) {
  if (line.starts_with('#')) line.remove_prefix(1);
  separator_ = separator_of(line);
  split(line, [this](std::size_t, std::string_view cell) { add_name(cell); });
  if (layout.given_names != nullptr) rename(*layout.given_names, where);
  places_.fill(missing);
  factors_.fill(1.0L);
  for (std::size_t place = 0; place < names_.size(); ++place) match(layout, place, where);
  require_units(where);
  for (std::size_t column = 0; column < layout.required_columns; ++column) {
    if (places_[column] != missing) {
      required_width_ = std::max(required_width_, places_[column] + 1);
      continue;
    }
    throw MissingColumn(where, layout.columns[column], line, unknown_);
  }
  if (separator_ == ' ') required_width_ = names_.size();  // between spaces no cell can be empty
}

/// Between spaces, a unit in brackets belongs to the name before it.
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
void CsvHeader::rename(ColumnNames& given, const std::string& where) {
  for (std::string& name : names_) {
    const auto found = given.own_by_given.find(name);
    if (found == given.own_by_given.end()) continue;
    given.found.insert(name);
    const auto unit = column_of(name).unit;
    const auto given_unit = column_of(found->second).unit;
    if (unit && given_unit && *unit != *given_unit) {
      std::string text = where + ": column \"";
      text.append(name).append("\" names the unit \"").append(*unit);
      throw IoError(text.append("\", but it is given as \"").append(found->second).append("\""));
    }
    name = found->second + (unit && !given_unit ? " [" + std::string(*unit) + "]" : "");
  }
}

/// Refuses a vector, or two times, of which only a part names another unit than that of the layout.
void CsvHeader::require_units(const std::string& where) const {
  for (std::size_t column = 1; column < max_columns; ++column) {
    for (const auto& [one, other] : {std::pair(column - 1, column), std::pair(column, column - 1)}) {
      if (places_[one] == missing || places_[other] == missing || own_units_[one] != own_units_[other])
        continue;
      if (factors_[one] == 1.0L || has_unit_[other]) continue;
      throw IoError(where + ": column " + std::to_string(places_[other] + 1) + " (" + name(other) +
                    ") names no unit, but column " + std::to_string(places_[one] + 1) + " (" + name(one) +
                    ") does");
    }
  }
}

void CsvHeader::match(const CsvLayout& layout, std::size_t place, const std::string& where) {
  const std::string& text = names_[place];
  const Column given = column_of(text);
  const std::string name = comparable(given.name, layout.synonyms);
  const auto described = [&] { return where + ": column " + std::to_string(place + 1) + " (" + text + ")"; };
  for (std::size_t column = 0; column < layout.columns.size(); ++column) {
    const Column own = column_of(layout.columns[column]);
    if (comparable(own.name, layout.synonyms) != name) continue;
    if (places_[column] != missing) {
      throw IoError(described() + ": column " + std::to_string(places_[column] + 1) + " (" +
                    names_[places_[column]] + ") is the same");
    }
    places_[column] = place;
    has_unit_[column] = given.unit.has_value();
    own_units_[column] = own.unit.value_or("");
    if (!given.unit || !own.unit) return;
    const auto factor = unit_factor(*given.unit, *own.unit);
    if (!factor) {
      throw IoError(described() + ": the unit \"" + std::string(*given.unit) +
                    "\" is unknown here; expected one of " + units_like(*own.unit));
    }
    factors_[column] = *factor;
    return;
  }
  unknown_.push_back(text);
}

}  // namespace sonopose::files
