#pragma once
/// \file
/// A number with its noun.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::text {

/// Returns "1 beacon", "2 beacons". `plural` is for a noun whose plural does not only add an s.
std::string count_text(std::uint64_t count, std::string_view noun, std::string_view plural = {});

/// Returns "FIRST", or for a `count` of 3 "FIRST and 2 more".
std::string first_of(std::string first, std::size_t count);

}  // namespace sonopose::text
