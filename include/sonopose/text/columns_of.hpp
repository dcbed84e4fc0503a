#pragma once
/// \file
/// The width of a text on a terminal.

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace sonopose::text {

/// True if a character of UTF-8 begins with this byte.
constexpr bool is_first_byte(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

/// Number of characters, not of bytes.
constexpr std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_first_byte));
}

}  // namespace sonopose::text
