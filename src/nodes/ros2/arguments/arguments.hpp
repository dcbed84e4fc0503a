#pragma once
/// \file
/// The arguments of every ROS 2 node, as `ros2 run` and `ros2 launch` pass them: `--ros-args … --`. Source:
/// design.ros2.org, "ROS Command Line Arguments"; rcl.

#include "logging/log.hpp"
#include "ros2/arguments/parameter_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2::arguments {

/// Lowest level that a logger publishes; without a name, that of all loggers.
struct LogRule {
  std::string logger;
  logging::Level level = logging::Level::info;
  bool operator==(const LogRule&) const = default;
};

struct Arguments {
  std::vector<std::string> own;       ///< arguments outside `--ros-args … --`
  std::vector<std::string> remap;     ///< "from:=to"
  std::vector<Parameter> parameters;  ///< from files and single arguments, in order: the last value counts
  std::optional<std::string> enclave;
  std::vector<LogRule> log_rules;
  bool rosout = true;  ///< false: disabled
};

/// Splits arguments and reads the parameter files. Throws std::invalid_argument, with argument and reason,
/// for an invalid argument, and ParameterFileError.
Arguments split(const std::vector<std::string>& arguments);

}  // namespace sonopose::ros2::arguments
