#pragma once
/// \file
/// Numbers of things.

#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::text {

/// "1 message", "2 messages": for nouns whose plural has an s.
inline std::string counted(std::uint64_t count, std::string_view noun) {
  std::string text = std::to_string(count) + " " + std::string(noun);
  if (count != 1) text += "s";
  return text;
}

}  // namespace sonopose::text
