#pragma once
/// \file
/// Bytes as text.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::text {

/// Formats each byte as two digits.
inline std::string hexadecimal(std::span<const std::byte> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::byte byte : bytes) {
    text += digits[std::to_integer<unsigned>(byte) >> 4U];
    text += digits[std::to_integer<unsigned>(byte) & 15U];
  }
  return text;
}

}  // namespace sonopose::text
