#include "ros2/arguments/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <stdexcept>

namespace sonopose::ros2::arguments {
namespace {

using Words = std::vector<std::string>;

LogRule parse_log_rule(const std::string& text) {
  using logging::Level;
  struct Named {
    const char* name;
    Level level;
  };
  constexpr std::array<Named, 5> levels{{{"debug", Level::debug},
                                         {"info", Level::info},
                                         {"warn", Level::warning},
                                         {"error", Level::error},
                                         {"fatal", Level::failure}}};
  const std::size_t assignment = text.find(":=");
  const bool has_logger = assignment != std::string::npos;
  std::string name = has_logger ? text.substr(assignment + 2) : text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found =
      std::find_if(levels.begin(), levels.end(), [&](const Named& each) { return name == each.name; });
  if (found == levels.end()) {
    throw std::invalid_argument(
        fmt::format("--log-level {}: the levels are debug, info, warn, error and fatal", text));
  }
  return {.logger = has_logger ? text.substr(0, assignment) : "", .level = found->level};
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> names) {
  return std::find(names.begin(), names.end(), word) != names.end();
}

/// Takes a switch without a value. Returns true if it was one.
bool take_switch(const std::string& word, Arguments& found) {
  if (is_one_of(word, {"--enable-rosout-logs", "--disable-rosout-logs"})) {
    found.rosout = word.starts_with("--enable");
    return true;
  }
  // Log lines always go to standard error, and there is no external logging library.
  return is_one_of(word, {"--enable-stdout-logs", "--disable-stdout-logs", "--enable-external-lib-logs",
                          "--disable-external-lib-logs"});
}

/// Takes an option with a value. Returns true if it was one.
bool take_option(const std::string& word, const std::string& value, Arguments& found) {
  if (is_one_of(word, {"-r", "--remap"})) {
    found.remap.push_back(value);
  } else if (is_one_of(word, {"-p", "--param"})) {
    found.parameters.push_back(parse_parameter(value));
  } else if (word == "--params-file") {
    auto parameters = read_parameter_file(value);
    found.parameters.insert(found.parameters.end(), std::make_move_iterator(parameters.begin()),
                            std::make_move_iterator(parameters.end()));
  } else if (is_one_of(word, {"-e", "--enclave"})) {
    found.enclave = value;
  } else if (word == "--log-level") {
    found.log_rules.push_back(parse_log_rule(value));
  } else {
    return is_one_of(word, {"--log-config-file", "--log-file-name"});  // for rcl's own log files
  }
  return true;
}

}  // namespace

Arguments split(const Words& arguments) {
  Arguments found;
  bool is_ros = false;
  for (auto word = arguments.begin(); word != arguments.end(); ++word) {
    if (*word == "--ros-args") {
      is_ros = true;
    } else if (!is_ros) {
      found.own.push_back(*word);
    } else if (*word == "--") {
      is_ros = false;
    } else if (!take_switch(*word, found)) {
      const auto value = std::next(word);
      if (value == arguments.end()) {
        throw std::invalid_argument(fmt::format("--ros-args: {} is unknown, or its value is missing", *word));
      }
      if (!take_option(*word, *value, found)) {
        throw std::invalid_argument(
            fmt::format("--ros-args: {} is unknown; options of this program stand before --ros-args or after "
                        "--",
                        *word));
      }
      word = value;
    }
  }
  return found;
}

}  // namespace sonopose::ros2::arguments
