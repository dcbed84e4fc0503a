#include "csv/layout.hpp"

#include "csv/column.hpp"

#include <algorithm>

namespace sonopose::csv {
namespace {

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

}  // namespace

std::optional<std::size_t> find_column(const Layout& layout, std::string_view name) {
  const std::string wanted = comparable(name, layout.synonyms);
  for (std::size_t column = 0; column < layout.columns.size(); ++column) {
    if (comparable(column_of(layout.columns[column]).name, layout.synonyms) == wanted) return column;
  }
  return std::nullopt;
}

bool has_column(const Layout& layout, std::string_view name) {
  return find_column(layout, column_of(name).name).has_value();
}

}  // namespace sonopose::csv
