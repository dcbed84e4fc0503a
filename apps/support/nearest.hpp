#pragma once
// Finds the known word that a misspelt one was meant to be.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::apps {

/// Returns the known word with the fewest edits to `word`, or one that begins with `word`. Empty if none is
/// near.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known);

/// Returns "; did you mean NEAREST?", or nothing if no known word is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace sonopose::apps
