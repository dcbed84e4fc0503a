#pragma once
// The options of a program as the keys of a file.

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace sonopose::apps {

/// Adds --config, a TOML file whose keys are the other options, and --print-config, which prints such a file.
void add_options_file(CLI::App& app, const std::string& group = "Options");

/// True for a program with these two options, which may run as a service.
bool has_options_file(const CLI::App& app);

/// True if a file or a parameter of ROS 2 can give this option: it is not hidden, and does not only print
/// something and exit.
bool is_key(const CLI::Option& option);

/// True if the arguments have this option.
bool is_given(const CLI::Option& option, const std::vector<std::string>& arguments);

/// An option that a file gives.
struct FileOption {
  std::string origin;               ///< "FILE:LINE: KEY"
  std::string name;                 ///< "--imu-rate"
  std::vector<std::string> values;  ///< empty for an empty array, and for a flag that is false
};

/// Returns the options in the file of --config and its drop-ins FILE.d/*.toml that `arguments` do not have.
/// Those of a program with settings are in its table [program]. Throws config::ConfigError.
std::vector<FileOption> file_options(const CLI::App& app, const std::vector<std::string>& arguments);

/// Replaces the values of an option, unless there are none. They are no words of a command line: they may be
/// empty, or begin with a dash. Parsing checks them, or run_callback(). Throws CLI::ValidationError for a
/// flag that is neither true nor false in YAML.
void give(CLI::Option& option, const std::vector<std::string>& values);

/// Prints every option with its description as TOML. Those that are not given are comments.
std::string options_toml(const CLI::App& app);

}  // namespace sonopose::apps
