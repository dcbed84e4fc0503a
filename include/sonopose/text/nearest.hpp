#pragma once
/// \file
/// The known word that a misspelt one was meant to be.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::text {

/// Returns the known word with the fewest edits to `word`, or one that begins with `word`. Empty if none is
/// near. Leading dashes and common groups (`drift.` in `drift.x` and `drift.y`) are not compared.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known);

/// Returns "; did you mean NEAREST?", or nothing if no known word is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace sonopose::text
