#include "ros2/arguments/parameter_file.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <yaml-cpp/yaml.h>

namespace sonopose::ros2::arguments {
namespace {

const std::string parameters_key = "ros__parameters";
const std::string any_node = "/**";

[[noreturn]] void refuse(const std::string& origin, const YAML::Node& node, const std::string& why) {
  throw ParameterFileError(fmt::format("{}, line {}: {}", origin, node.Mark().line + 1, why));
}

std::string absolute(const std::string& name) {
  return name.starts_with('/') ? name : "/" + name;
}

/// A scalar or a list of scalars as text. YAML's true and false may be capitalised.
std::vector<std::string> values_of(const YAML::Node& node, const std::string& origin) {
  if (node.IsSequence()) {
    std::vector<std::string> values;
    for (const YAML::Node& each : node) {
      if (!each.IsScalar()) refuse(origin, each, "a list may contain only single values");
      values.push_back(values_of(each, origin).front());
    }
    return values;
  }
  if (!node.IsScalar()) refuse(origin, node, "a parameter needs a value");
  const std::string& text = node.Scalar();
  if (text == "True" || text == "TRUE") return {"true"};
  if (text == "False" || text == "FALSE") return {"false"};
  return {text};
}

/// Adds the parameters below `prefix`.
void add_parameters(const YAML::Node& map, const std::string& prefix, const Parameter& of_node,
                    std::vector<Parameter>& found) {
  if (!map.IsMap()) refuse(of_node.origin, map, parameters_key + " must contain names and values");
  for (const auto& entry : map) {
    Parameter parameter = of_node;
    parameter.name = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      add_parameters(entry.second, parameter.name + ".", of_node, found);
    } else {
      parameter.values = values_of(entry.second, of_node.origin);
      found.push_back(std::move(parameter));
    }
  }
}

/// Adds the parameters of all nodes in the namespace `path`.
void add_nodes(const YAML::Node& map, const std::string& path, const std::string& origin,
               std::vector<Parameter>& found) {
  if (!map.IsMap()) refuse(origin, map, "expected node names, and below them " + parameters_key);
  for (const auto& entry : map) {
    const std::string key = entry.first.Scalar();
    if (key == parameters_key) {
      if (path.empty()) refuse(origin, entry.first, parameters_key + " belongs below the name of a node");
      add_parameters(entry.second, "", {.node = path, .name = {}, .values = {}, .origin = origin}, found);
    } else {
      add_nodes(entry.second, path + absolute(key), origin, found);
    }
  }
}

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts;
  for (std::size_t begin = 1, end = 0; begin <= name.size(); begin = end + 1) {
    end = std::min(name.find('/', begin), name.size());
    parts.push_back(name.substr(begin, end - begin));
  }
  return parts;
}

using Part = std::vector<std::string>::const_iterator;

bool selects(Part pattern, Part pattern_end, Part name, Part name_end) {
  if (pattern == pattern_end) return name == name_end;
  if (*pattern == "**") {
    return selects(pattern + 1, pattern_end, name, name_end) ||
           (name != name_end && selects(pattern, pattern_end, name + 1, name_end));
  }
  if (name == name_end || (*pattern != "*" && *pattern != *name)) return false;
  return selects(pattern + 1, pattern_end, name + 1, name_end);
}

}  // namespace

std::vector<Parameter> read_parameter_file(const std::filesystem::path& file) {
  std::vector<Parameter> found;
  try {
    const YAML::Node root = YAML::Load(files::read_text(file));
    if (!root.IsNull()) add_nodes(root, "", file.string(), found);
  } catch (const files::IoError& error) {
    throw ParameterFileError(error.what());
  } catch (const YAML::Exception& error) {
    throw ParameterFileError(fmt::format("{}, line {}: {}", file.string(), error.mark.line + 1, error.msg));
  }
  return found;
}

Parameter parse_parameter(const std::string& text) {
  const auto refuse_text = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("-p {}: {}", text, why));
  };
  const std::size_t assignment = text.find(":=");
  if (assignment == std::string::npos) refuse_text("it must be NAME:=VALUE");
  std::string name = text.substr(0, assignment);
  std::string node = any_node;
  if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
    node = absolute(name.substr(0, colon));
    name.erase(0, colon + 1);
  }
  if (name.empty()) refuse_text("there is no name before ':='");
  Parameter parameter{.node = node, .name = name, .values = {}, .origin = "-p " + text};
  try {
    const YAML::Node value = YAML::Load(text.substr(assignment + 2));
    if (!value.IsScalar() && !value.IsSequence()) refuse_text("a parameter needs a value");
    parameter.values = values_of(value, parameter.origin);
  } catch (const YAML::Exception& error) {
    refuse_text(error.msg);
  } catch (const ParameterFileError& error) {
    throw std::invalid_argument(error.what());
  }
  return parameter;
}

bool selects(const std::string& pattern, const std::string& full_name) {
  const auto pattern_parts = parts_of(pattern);
  const auto name_parts = parts_of(full_name);
  return selects(pattern_parts.begin(), pattern_parts.end(), name_parts.begin(), name_parts.end());
}

}  // namespace sonopose::ros2::arguments
