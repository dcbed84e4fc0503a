#include "mcap/omg_idl.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <span>
#include <vector>

namespace sonopose::mcap {
namespace {

using Tokens = std::vector<std::string_view>;

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

/// The end of the comment that begins at `at`; `at` if none does.
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

/// From the word that begins the definition of `name` to its last token; empty if there is none.
std::span<const std::string_view> find_definition(const Tokens& tokens, std::string_view name) {
  const auto defines = [](std::string_view word) {
    return word == "struct" || word == "enum" || word == "union" || word == "typedef" || word == "const";
  };
  std::size_t begin = 0;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (defines(tokens[i])) begin = i;
    const std::string_view next = i + 1 < tokens.size() ? tokens[i + 1] : std::string_view();
    const bool is_body = next == "{" && i > 0 && defines(tokens[i - 1]);
    const bool is_value = (next == "=" && tokens[begin] == "const") ||
                          ((next == ";" || next == "[") && tokens[begin] == "typedef");
    if (tokens[i] != name || !(is_body || is_value)) continue;
    const auto last =
        std::find(tokens.begin() + static_cast<std::ptrdiff_t>(i), tokens.end(), is_body ? "}" : ";");
    return {tokens.begin() + static_cast<std::ptrdiff_t>(begin), last};
  }
  return {};
}

}  // namespace

std::string definition_in(std::string_view idl, std::string_view type_name) {
  const Tokens tokens = tokens_of(idl);
  const std::size_t scope = type_name.rfind(':');
  std::vector<std::string_view> wanted{scope == std::string_view::npos ? type_name
                                                                       : type_name.substr(scope + 1)};
  std::set<std::string_view> known;
  std::string text;
  while (!wanted.empty()) {
    const std::string_view name = wanted.back();
    wanted.pop_back();
    if (!known.insert(name).second) continue;
    for (const std::string_view token : find_definition(tokens, name)) {
      text.append(token).append(" ");
      wanted.push_back(token);
    }
  }
  return text;
}

}  // namespace sonopose::mcap
