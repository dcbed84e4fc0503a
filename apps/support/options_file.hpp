#pragma once
// The options of a program as the keys of a file.

#include "command_line.hpp"

#include <string>
#include <vector>

namespace sonopose::apps {

/// Adds --config, a TOML file whose keys are the other options, and --print-config, which prints such a file.
void add_options_file(CommandLine& app, const std::string& group = "Options");

/// True for a program with these two options, which may run as a service.
bool has_options_file(const CommandLine& app);

/// True if a file or a parameter of ROS 2 can give this option: it is not hidden, and does not only print
/// something and exit.
bool is_key(const Option& option);

/// True if the arguments have this option.
bool is_given(const Option& option, const std::vector<std::string>& arguments);

/// An option that a file gives.
struct FileOption {
  std::string origin;               ///< "FILE:LINE: KEY"
  std::string name;                 ///< "--imu-rate"
  std::vector<std::string> values;  ///< empty for an empty array, and for a flag that is false
};

/// Returns the options in the file of --config and its drop-ins FILE.d/*.toml that `arguments` do not have.
/// Those of a program with settings are in its table [program]. Throws config::ConfigError.
std::vector<FileOption> file_options(const CommandLine& app, const std::vector<std::string>& arguments);

/// Replaces the values of an option, unless there are none, before they are parsed. They are no words of a
/// command line: they may be empty, or begin with a dash. Throws the error of a command line for a flag that
/// is neither true nor false in YAML.
void give(Option option, const std::vector<std::string>& values);

/// Replaces the values of an option after the command line was parsed. Throws std::invalid_argument.
void assign(Option option, const std::vector<std::string>& values);

/// Prints every option with its description as TOML. Those that are not given are comments.
std::string options_toml(const CommandLine& app);

}  // namespace sonopose::apps
