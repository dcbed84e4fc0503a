#pragma once
/// \file
/// Regular expressions in texts. <regex> takes the compiler three seconds in every file, so few files but
/// matches.cpp include it.

#include <string>
#include <vector>

namespace sonopose::test {

/// Groups of each match of an ECMAScript expression; group 0 is the whole match.
std::vector<std::vector<std::string>> all_matches(const std::string& text, const std::string& expression);

/// Groups of the first match; empty if there is none.
std::vector<std::string> first_match(const std::string& text, const std::string& expression);

/// The text with every match replaced.
std::string replace_matches(const std::string& text, const std::string& expression,
                            const std::string& replacement);

/// Number after `key=`; NaN if missing.
double value_of(const std::string& text, const std::string& key);

}  // namespace sonopose::test
