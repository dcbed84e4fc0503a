#include "files/csv_header.hpp"

#include "files/column_units.hpp"
#include "files/error.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

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
  if (last != std::string_view::npos && last > 0 && last + 1 < cell.size() &&
      is_unit(cell.substr(last + 1))) {
    return {cell.substr(0, last), cell.substr(last + 1)};
  }
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

CsvHeader::CsvHeader(const CsvLayout& layout, std::string_view line, const std::string& where) {
  if (line.starts_with('#')) line.remove_prefix(1);
  separator_ = separator_of(line);
  split(line, [this](std::size_t, std::string_view cell) { names_.emplace_back(cell); });
  places_.fill(missing);
  factors_.fill(1.0L);
  for (std::size_t place = 0; place < names_.size(); ++place) match(layout, place, where);
  for (std::size_t column = 0; column < layout.required_columns; ++column) {
    if (places_[column] != missing) {
      required_width_ = std::max(required_width_, places_[column] + 1);
      continue;
    }
    throw IoError(where + ": the header has no column \"" + std::string(layout.columns[column]) + "\": \"" +
                  std::string(line) + "\"");
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
