#pragma once
// The options of a program as the keys of a file.

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace sonopose::apps {

/// Adds --config, a TOML file whose keys are the other options, and --print-config, which prints such a file.
void add_options_file(CLI::App& app, const std::string& group = "Options");

/// True if the arguments have this option.
bool is_given(const CLI::Option& option, const std::vector<std::string>& arguments);

/// An option that a file gives.
struct FileOption {
  std::string origin;  ///< "FILE:LINE: KEY"
  std::string name;    ///< "--imu-rate"
  std::vector<std::string> arguments;
};

/// Returns the options in the file of --config and its drop-ins FILE.d/*.toml that `arguments` do not have.
/// Those of a program with settings are in its table [program]. Throws config::ConfigError.
std::vector<FileOption> file_options(const CLI::App& app, const std::vector<std::string>& arguments);

/// Returns the arguments of all options.
std::vector<std::string> arguments_of(const std::vector<FileOption>& options);

/// Prints every option with its description as TOML. Those that are not given are comments.
std::string options_toml(const CLI::App& app);

}  // namespace sonopose::apps
