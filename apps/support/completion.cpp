#include "completion.hpp"

#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::apps {
namespace {

/// Returns what can follow an option.
std::string values_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "-";
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');  // of CLI::IsMember
  const std::size_t end = type.find('}');
  if (begin != std::string::npos && end != std::string::npos) {
    std::string words = type.substr(begin + 1, end - begin - 1);
    std::replace(words.begin(), words.end(), ',', '|');
    return words;
  }
  const std::string& text = option.get_option_text();
  const std::string values = text.empty() ? type.substr(0, type.find(':')) : text.substr(0, text.find(" ("));
  return values.empty() ? "TEXT" : values;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string option_lines(const CLI::App& app, const std::string& command) {
  std::string lines;
  for (const CLI::Option* const option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) {
      lines += fmt::format("{}\t--{}\t{}\t{}\n", command, name, values_of(*option),
                           first_line(option->get_description()));
    }
  }
  return lines;
}

}  // namespace

void add_completions(CLI::App& app) {
  app.add_flag_callback("--print-completions", [&app] { throw Printed(completions(app)); })->group("");
}

std::string completions(const CLI::App& app) {
  std::string lines = option_lines(app, "-");
  for (const CLI::App* const command : app.get_subcommands(nullptr)) {
    lines += fmt::format("-\t{}\t-\t{}\n", command->get_name(), first_line(command->get_description()));
    lines += option_lines(*command, command->get_name());
  }
  return lines;
}

}  // namespace sonopose::apps
