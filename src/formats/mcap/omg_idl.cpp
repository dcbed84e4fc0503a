#include "mcap/omg_idl.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace sonopose::mcap {
namespace {

using Tokens = std::vector<std::string_view>;

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

/// Returns the end of the comment that begins at `at`; `at` if there is none.
std::size_t end_of_comment(std::string_view text, std::size_t at) {
  const auto rest = text.substr(at);
  std::size_t end = at;
  if (rest.starts_with("//")) end = text.find('\n', at);
  if (rest.starts_with("/*")) end = std::min(text.find("*/", at + 2), text.size() - 2) + 2;
  return std::min(end, text.size());
}

Tokens tokens_of(std::string_view text) {
  Tokens tokens;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t after = end_of_comment(text, at);
    std::size_t end = after;
    while (end < text.size() && is_word(text[end])) ++end;
    if (after == at && end == at) ++end;
    const auto token = text.substr(after, end - after);
    if (!token.empty() && std::isspace(static_cast<unsigned char>(token.front())) == 0)
      tokens.push_back(token);
    at = end;
  }
  return tokens;
}

using Definition = std::span<const std::string_view>;

/// Returns definitions by name, from keyword to last token. None is nested in another.
std::map<std::string_view, Definition> definitions_in(const Tokens& tokens) {
  const auto defines = [](std::string_view word) {
    return word == "struct" || word == "enum" || word == "union" || word == "typedef" || word == "const";
  };
  std::map<std::string_view, Definition> definitions;
  std::size_t begin = 0;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    if (defines(tokens[i])) begin = i;
    const std::string_view next = tokens[i + 1];
    const bool is_body = next == "{" && i > 0 && defines(tokens[i - 1]);
    const bool is_value = (next == "=" && tokens[begin] == "const") ||
                          ((next == ";" || next == "[") && tokens[begin] == "typedef");
    if (!is_body && !is_value) continue;
    const auto at = tokens.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last = std::find(at, tokens.end(), is_body ? "}" : ";");
    definitions.try_emplace(*at, tokens.begin() + static_cast<std::ptrdiff_t>(begin), last);
    i = begin = static_cast<std::size_t>(last - tokens.begin());
    if (last == tokens.end()) break;
  }
  return definitions;
}

}  // namespace

std::string definition_in(std::string_view idl, std::string_view type_name) {
  const Tokens tokens = tokens_of(idl);
  const auto definitions = definitions_in(tokens);
  const std::size_t scope = type_name.rfind(':');
  std::vector<std::string_view> wanted{scope == std::string_view::npos ? type_name
                                                                       : type_name.substr(scope + 1)};
  std::set<std::string_view> known;
  std::string text;
  while (!wanted.empty()) {
    const std::string_view name = wanted.back();
    wanted.pop_back();
    if (!known.insert(name).second) continue;
    const auto found = definitions.find(name);
    if (found == definitions.end()) continue;
    for (const std::string_view token : found->second) {
      text.append(token).append(" ");
      wanted.push_back(token);
    }
  }
  return text;
}

}  // namespace sonopose::mcap
