#pragma once
// An option that takes one of a few words.

#include "command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::apps {

template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// Adds an option whose words stand for values. (CLI11's CheckedTransformer also takes the values' numbers,
/// and shows an enum of one byte as a character.) `value` must outlive the parsing; its word is the default.
template <class Value>
Option add_choice(CommandLine& app, const std::string& name, Value& value, const Words<Value>& words,
                  const std::string& help) {
  std::vector<std::string> texts;
  std::string default_word;
  for (const auto& [word, meaning] : words) {
    texts.push_back(word);
    if (meaning == value) default_word = word;
  }
  const auto set = [&value, words](const std::string& text) {
    const auto is_it = [&](const auto& each) { return each.first == text; };
    value = std::find_if(words.begin(), words.end(), is_it)->second;
  };
  return app.add_option_function<std::string>(name, set, help)
      .check(one_of(texts))
      .option_text(fmt::format("{}", fmt::join(texts, "|")) +
                   (default_word.empty() ? "" : " (default: " + default_word + ")"));
}

}  // namespace sonopose::apps
