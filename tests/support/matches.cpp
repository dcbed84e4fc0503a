#include "support/matches.hpp"

#include <cmath>
#include <regex>

namespace sonopose::test {

std::vector<std::vector<std::string>> all_matches(const std::string& text, const std::string& expression) {
  const std::regex compiled(expression);
  std::vector<std::vector<std::string>> matches;
  for (std::sregex_iterator each(text.begin(), text.end(), compiled), end; each != end; ++each) {
    matches.emplace_back(each->begin(), each->end());
  }
  return matches;
}

std::vector<std::string> first_match(const std::string& text, const std::string& expression) {
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(expression))) return {};
  return {match.begin(), match.end()};
}

std::string replace_matches(const std::string& text, const std::string& expression,
                            const std::string& replacement) {
  return std::regex_replace(text, std::regex(expression), replacement);
}

double value_of(const std::string& text, const std::string& key) {
  const auto match = first_match(text, key + "=(-?[0-9.]+)");
  return match.empty() ? std::nan("") : std::stod(match[1]);
}

}  // namespace sonopose::test
