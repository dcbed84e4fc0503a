#include "ros2_command_line.hpp"

#include "options_file.hpp"
#include "ros2/relay/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
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

/// True unless ROS 2 has another argument for this option.
bool is_parameter(const Option& option) {
  constexpr std::array others{"--name", "--namespace", "--remap", "--enclave", "--security"};
  return is_key(option) &&
         std::ranges::none_of(others, [&](const char* name) { return option.has_name(name); });
}

std::optional<Option> option_of(const Ros2Program& program, const Parameter& parameter) {
  const std::string name = option_name(parameter.name);
  if (!program.app.has_option(name) || !is_parameter(program.app.option(name))) return std::nullopt;
  return program.app.option(name);
}

/// Gives an option its values, in place of those of a file.
void assign_parameter(Option option, const Parameter& parameter) {
  try {
    assign(option, parameter.values);  // none of an empty list
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", parameter.origin, error.what()));
  }
}

/// Returns the value of a text as YAML has it.
settings::SettingValue scalar_of(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  const char* const end = text.data() + text.size();
  int whole = 0;
  if (const auto [rest, error] = std::from_chars(text.data(), end, whole);
      error == std::errc() && rest == end) {
    return whole;
  }
  double real = 0;
  if (const auto [rest, error] = std::from_chars(text.data(), end, real);
      error == std::errc() && rest == end) {
    return real;
  }
  return text;
}

/// Returns numbers if all texts are, otherwise the texts.
ros2::relay::OptionValue list_of(const std::vector<std::string>& texts) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    const settings::SettingValue value = scalar_of(text);
    if (const auto* const whole = std::get_if<int>(&value)) numbers.push_back(*whole);
    if (const auto* const real = std::get_if<double>(&value)) numbers.push_back(*real);
  }
  if (numbers.size() == texts.size()) return numbers;
  return texts;
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

/// Returns false unless it is an override of QoS.
bool add_override(const Parameter& parameter, ros2::QosOverrides& overrides) {
  try {
    return overrides.add(parameter.name,
                         parameter.values.size() == 1 ? parameter.values.front() : std::string());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}: {}", parameter.origin, parameter.name, error.what()));
  }
}

}  // namespace

Ros2Program::Ros2Program() {
  add_bus_options(app, bus);
  add_ros2_options(app, ros2);
  add_log_option(app, log_level);
  add_options_file(app, "ROS 2 node");
}

std::vector<std::string> own_arguments(const Arguments& arguments) {
  std::vector<std::string> own = arguments.own;
  for (const std::string& rule : arguments.remap) own.push_back("--remap=" + rule);
  if (arguments.enclave) own.push_back("--enclave=" + *arguments.enclave);
  return own;
}

OtherParameters apply_parameters(const Arguments& arguments, Ros2Program& program) {
  const std::string node = ros2::full_name(node_name(program.ros2));
  std::vector<Parameter> selected;
  for (const Parameter& parameter : arguments.parameters) {
    if (!ros2::arguments::selects(parameter.node, node)) continue;
    std::erase_if(selected, [&](const Parameter& earlier) { return earlier.name == parameter.name; });
    selected.push_back(parameter);
  }
  const auto own = own_arguments(arguments);
  OtherParameters others;
  for (const Parameter& parameter : selected) {
    if (parameter.name == "start_type_description_service") continue;  // of every node of Jazzy; we have none
    if (const auto option = option_of(program, parameter)) {
      if (!is_given(*option, own)) assign_parameter(*option, parameter);
    } else if (ros2::relay::setting_named(parameter.name)) {
      others.settings.push_back(setting_of(parameter));
    } else if (add_override(parameter, others.qos_overrides)) {
      others.given[parameter.name] = scalar_of(parameter.values.front());
    } else {
      logging::warning(fmt::format("{}: {} is neither a setting nor an option of the relay; {}",
                                   parameter.origin, parameter.name,
                                   ros2::relay::why_unknown(parameter.name)));
    }
  }
  return others;
}

ros2::relay::OptionParameters option_parameters(const Ros2Program& program) {
  ros2::relay::OptionParameters parameters;
  for (const Option& option : program.app.options()) {
    if (!is_parameter(option)) continue;
    std::string name = option.single_name();
    std::replace(name.begin(), name.end(), '-', '_');
    const bool is_flag = option.max_values() == 0;
    if (option.count() == 0) {
      const std::string text = is_flag ? "false" : option.default_text();
      if (!text.empty()) parameters[name] = scalar_of(text);
    } else if (option.max_values() > 1) {
      parameters[name] = list_of(option.results());
    } else {
      parameters[name] = scalar_of(option.results().back());
    }
  }
  return parameters;
}

logging::Level log_level(const Arguments& arguments, const ros2::NodeName& node, const Ros2Program& program) {
  auto level = program.log_level;
  for (const ros2::arguments::LogRule& rule : arguments.log_rules) {
    if (rule.logger.empty() || rule.logger == ros2::logger_name(node)) level = rule.level;
  }
  return level;
}

}  // namespace sonopose::apps
