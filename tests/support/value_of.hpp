#pragma once
/// \file
/// Numbers in the output of programs.

#include <cmath>
#include <regex>
#include <string>

namespace sonopose::test {

/// Number after `key=`; NaN if missing.
inline double value_of(const std::string& text, const std::string& key) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(key + "=(-?[0-9.]+)")) ? std::stod(match[1])
                                                                          : std::nan("");
}

}  // namespace sonopose::test
