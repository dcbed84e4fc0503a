#pragma once
// The known word that a misspelt one was meant to be.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::apps {

/// The known word with the fewest edits to `word`, or one that `word` begins. Empty where none is near.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known);

/// "; did you mean NEAREST?", or nothing where no known word is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace sonopose::apps
