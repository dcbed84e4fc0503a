#pragma once
// The command line of the relay: its own options, and those of every ROS 2 node (--ros-args).

#include "bus_options.hpp"
#include "log_option.hpp"
#include "ros2/arguments/arguments.hpp"
#include "ros2_options.hpp"

#include <string>
#include <vector>

namespace sonopose::apps {

/// The program and the values of its options. Not copyable: the options refer to the values.
struct Ros2Program {
  Ros2Program();

  BusOptions bus;
  Ros2Options ros2;
  logging::Level log_level = logging::Level::info;
  Program app{"ros2"};
};

/// Returns the relay's own arguments, with the remap rules and the enclave of --ros-args as own options.
std::vector<std::string> own_arguments(const ros2::arguments::Arguments& arguments);

/// Parameters that are no options.
struct OtherParameters {
  std::vector<ros2::relay::StartupSetting> settings;  ///< settings of the fusion
  ros2::QosOverrides qos_overrides;
  ros2::relay::OptionParameters given;  ///< the overrides by their names
};

/// Gives the parameters to `program`, already parsed: to its options, unless the command line has them, and
/// returns the others. Unknown parameters cause a warning on standard error. Throws std::invalid_argument
/// with the origin of the parameter.
OtherParameters apply_parameters(const ros2::arguments::Arguments& arguments, Ros2Program& program);

/// Returns the options in use as parameters: those that are given or have a default.
ros2::relay::OptionParameters option_parameters(const Ros2Program& program);

/// Returns the least level of the lines that the node logs, from ROS 2's own argument or else from
/// --log-level.
logging::Level log_level(const ros2::arguments::Arguments& arguments, const ros2::NodeName& node,
                         const Ros2Program& program);

}  // namespace sonopose::apps
