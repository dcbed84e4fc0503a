#pragma once
/// \file
/// Parameters of ROS 2 nodes in YAML.

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::ros2::arguments {

struct Parameter {
  std::string node;                 ///< pattern of full node names: "/robot/kart", "/*/kart", "/**"
  std::string name;                 ///< "delay.processing_s"
  std::vector<std::string> values;  ///< one value, or those of a list
  std::string origin;               ///< for messages: "robot.yaml", "-p tf:=off"
};

/// Failure to read a file. The message names the file, the line and the reason.
class ParameterFileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The parameters of all nodes in a file, in order:
///
///     /**:
///       ros__parameters:
///         delay: {processing_s: 0.07}
///
/// Throws ParameterFileError.
std::vector<Parameter> read_parameter_file(const std::filesystem::path& file);

/// Parses `[node:]name:=yaml`. Throws std::invalid_argument.
Parameter parse_parameter(const std::string& text);

/// True if a pattern selects a node by its full name. `*` is one part of the name, `**` any number of parts.
bool selects(const std::string& pattern, const std::string& full_name);

}  // namespace sonopose::ros2::arguments
