#include "nearest.hpp"

#include <sonopose/text/edit_distance.hpp>

#include <algorithm>

namespace sonopose::apps {
namespace {

/// Removes the leading dashes, which all options have in common.
std::string_view letters_of(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  return word;
}

/// Returns the distance of two words. The beginning of a word is near it.
std::size_t distance(std::string_view word, std::string_view known) {
  const bool is_beginning = word.size() >= 3 && known.starts_with(word);
  return is_beginning ? 1 : text::edit_distance(word, known);
}

}  // namespace

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string_view letters = letters_of(word);
  std::size_t least = letters.size() / 3 + 2;  // a greater distance means another word
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
