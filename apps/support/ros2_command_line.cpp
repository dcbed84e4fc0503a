#include "ros2_command_line.hpp"

#include "ros2/relay/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace sonopose::apps {
namespace {

using ros2::arguments::Arguments;
using ros2::arguments::Parameter;

/// Converts "map_frame" to "--map-frame".
std::string option_name(const std::string& parameter) {
  std::string name = "--" + parameter;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// Returns the option of a parameter; null if there is none, or if ROS 2 has another argument for it.
const CLI::Option* option_of(const Ros2Program& program, const Parameter& parameter) {
  constexpr std::array others{"--help", "--version", "--name", "--namespace", "--remap", "--enclave"};
  const std::string name = option_name(parameter.name);
  if (std::find(others.begin(), others.end(), name) != others.end()) return nullptr;
  return program.app.get_option_no_throw(name);
}

void add_option(const CLI::Option& option, const Parameter& parameter, std::vector<std::string>& arguments) {
  const std::string name = option_name(parameter.name);
  if (option.get_type_size() > 1) {
    arguments.push_back(name);
    arguments.insert(arguments.end(), parameter.values.begin(), parameter.values.end());
  } else {
    for (const std::string& value : parameter.values) arguments.push_back(fmt::format("{}={}", name, value));
  }
}

ros2::arguments::LogLevel ros2_level(logging::Level level) {
  using ros2::arguments::LogLevel;
  if (level == logging::Level::debug) return LogLevel::debug;
  if (level == logging::Level::info) return LogLevel::info;
  return level == logging::Level::warning ? LogLevel::warning : LogLevel::error;
}

ros2::relay::StartupSetting setting_of(const Parameter& parameter) {
  if (parameter.values.size() != 1) {
    throw std::invalid_argument(
        fmt::format("{}: {} must have a single value", parameter.origin, parameter.name));
  }
  ros2::relay::StartupSetting setting{.parameter = parameter.name, .value = parameter.values.front()};
  try {
    check(setting);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(parameter.origin + ": " + error.what());
  }
  return setting;
}

}  // namespace

Ros2Program::Ros2Program() {
  add_bus_options(app, bus);
  add_ros2_options(app, ros2);
  add_log_option(app, log_level);
}

std::vector<std::string> own_arguments(const Arguments& arguments) {
  std::vector<std::string> own = arguments.own;
  for (const std::string& rule : arguments.remap) own.push_back("--remap=" + rule);
  if (arguments.enclave) own.push_back("--enclave=" + *arguments.enclave);
  return own;
}

AppliedParameters apply_parameters(const Arguments& arguments, const Ros2Program& given) {
  const std::string node = ros2::full_name(node_name(given.ros2));
  std::vector<Parameter> selected;
  for (const Parameter& parameter : arguments.parameters) {
    if (!ros2::arguments::selects(parameter.node, node)) continue;
    std::erase_if(selected, [&](const Parameter& earlier) { return earlier.name == parameter.name; });
    selected.push_back(parameter);
  }
  AppliedParameters applied;
  for (const Parameter& parameter : selected) {
    if (const CLI::Option* const option = option_of(given, parameter)) {
      if (option->count() == 0) add_option(*option, parameter, applied.arguments);
    } else if (ros2::relay::setting_named(parameter.name)) {
      applied.settings.push_back(setting_of(parameter));
    } else {
      logging::warning(fmt::format("{}: {} is neither a setting nor an option of the relay; {}",
                                   parameter.origin, parameter.name,
                                   ros2::relay::why_unknown(parameter.name)));
    }
  }
  return applied;
}

ros2::arguments::LogLevel log_level(const Arguments& arguments, const ros2::NodeName& node,
                                    const Ros2Program& program) {
  auto level = ros2_level(program.log_level);
  for (const ros2::arguments::LogRule& rule : arguments.log_rules) {
    if (rule.logger.empty() || rule.logger == ros2::logger_name(node)) level = rule.level;
  }
  return level;
}

}  // namespace sonopose::apps
