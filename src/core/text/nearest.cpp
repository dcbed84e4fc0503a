#include <sonopose/text/nearest.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace sonopose::text {
namespace {

/// Levenshtein distance: the least number of bytes to insert, delete or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Removes leading dashes, which all options have in common.
std::string_view letters_of(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  return word;
}

/// Length of the groups that both words begin with, including the point behind each.
std::size_t common_groups(std::string_view a, std::string_view b) {
  const std::size_t length = std::min(a.size(), b.size());
  std::size_t groups = 0;
  for (std::size_t i = 0; i < length && a[i] == b[i]; ++i) {
    if (a[i] == '.') groups = i + 1;
  }
  return groups;
}

}  // namespace

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t min_beginning = 3;
  std::optional<std::string> found;
  std::size_t least = word.size();
  for (const std::string& candidate : known) {
    std::string_view rest = letters_of(word);
    std::string_view meant = letters_of(candidate);
    const std::size_t groups = common_groups(rest, meant);
    rest.remove_prefix(groups);
    meant.remove_prefix(groups);
    const bool is_beginning = rest.size() >= min_beginning && meant.starts_with(rest);
    const std::size_t edits = is_beginning ? 1 : edit_distance(rest, meant);
    // A greater distance means another word.
    if (edits >= least || edits > rest.size() / 3 + 1 || edits >= rest.size()) continue;
    least = edits;
    found = candidate;
  }
  return found;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const auto meant = nearest(word, known);
  return meant ? "; did you mean " + *meant + "?" : std::string();
}

}  // namespace sonopose::text
