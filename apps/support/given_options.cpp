#include "given_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace sonopose::apps {
namespace {

std::vector<Option> options_of(const CommandLine& app, const std::string& group) {
  std::vector<Option> options = app.options();
  std::erase_if(options, [&](const Option& option) { return option.group_name() != group; });
  return options;
}

}  // namespace

NamedValues option_values(const CommandLine& app, const std::string& group,
                          const std::vector<std::string>& always) {
  NamedValues values;
  for (const Option& option : options_of(app, group)) {
    std::string name = option.single_name();
    const bool wanted = std::find(always.begin(), always.end(), name) != always.end();
    const std::string value =
        option.count() > 0 ? fmt::format("{}", fmt::join(option.results(), " ")) : option.default_text();
    if (option.count() == 0 && (!wanted || value.empty())) continue;
    std::replace(name.begin(), name.end(), '-', '_');
    values.emplace_back(name, value);
  }
  return values;
}

std::vector<std::string> option_arguments(const CommandLine& app, const std::string& group) {
  std::vector<std::string> arguments;
  for (const Option& option : options_of(app, group)) {
    for (const std::string& value : option.results()) {
      arguments.push_back(fmt::format("--{}={}", option.single_name(), value));
    }
  }
  return arguments;
}

}  // namespace sonopose::apps
