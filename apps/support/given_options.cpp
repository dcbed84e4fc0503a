#include "given_options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::apps {
namespace {

std::vector<const CLI::Option*> options_of(const CLI::App& app, const std::string& group) {
  return app.get_options([&](const CLI::Option* option) { return option->get_group() == group; });
}

}  // namespace

NamedValues option_values(const CLI::App& app, const std::string& group,
                          const std::vector<std::string>& always) {
  NamedValues values;
  for (const CLI::Option* option : options_of(app, group)) {
    std::string name = option->get_single_name();
    const bool wanted = std::find(always.begin(), always.end(), name) != always.end();
    const std::string value =
        option->count() > 0 ? CLI::detail::join(option->results(), " ") : option->get_default_str();
    if (option->count() == 0 && (!wanted || value.empty())) continue;
    std::replace(name.begin(), name.end(), '-', '_');
    values.emplace_back(name, value);
  }
  return values;
}

std::vector<std::string> option_arguments(const CLI::App& app, const std::string& group) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : options_of(app, group)) {
    for (const std::string& value : option->results()) {
      arguments.push_back(fmt::format("--{}={}", option->get_single_name(), value));
    }
  }
  return arguments;
}

}  // namespace sonopose::apps
