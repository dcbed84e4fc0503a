#pragma once
/// \file
/// The distance between two words, to find the one meant by a misspelt one.

#include <cstddef>
#include <string_view>

namespace sonopose::text {

/// Levenshtein distance: the least number of bytes to insert, delete or replace.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace sonopose::text
