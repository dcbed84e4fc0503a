#pragma once
/// \file
/// Numbers in the texts of programs.

#include <cmath>
#include <regex>
#include <string>

namespace sonopose::test {

/// The number after `key=`; NaN if there is none.
inline double value_of(const std::string& text, const std::string& key) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(key + "=(-?[0-9.]+)")) ? std::stod(match[1])
                                                                          : std::nan("");
}

}  // namespace sonopose::test
