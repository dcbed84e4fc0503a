#include "nearest.hpp"

#include <algorithm>
#include <numeric>

namespace sonopose::apps {
namespace {

/// Levenshtein's distance.
std::size_t edits_between(std::string_view a, std::string_view b) {
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

/// The dashes in front do not count: all options have them.
std::string_view letters_of(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  return word;
}

/// How far two words are apart; the beginning of a word is near it.
std::size_t distance(std::string_view word, std::string_view known) {
  const bool is_beginning = word.size() >= 3 && known.starts_with(word);
  return is_beginning ? 1 : edits_between(word, known);
}

}  // namespace

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string_view letters = letters_of(word);
  std::size_t least = letters.size() / 3 + 2;  // farther than that, another word was meant
  std::optional<std::string> found;
  for (const std::string& candidate : known) {
    const std::size_t edits = distance(letters, letters_of(candidate));
    if (edits >= least || edits >= letters.size()) continue;
    least = edits;
    found = candidate;
  }
  return found;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const auto meant = nearest(word, known);
  return meant ? "; did you mean " + *meant + "?" : std::string();
}

}  // namespace sonopose::apps
