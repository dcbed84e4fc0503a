#pragma once
// The start and end of every program, with or without the bus.

#include "output.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::apps {

/// The command line of the program sonopose-VERB: name, description (verbs.hpp) and --version.
class Program : public CLI::App {
public:
  /// `details` follow the description in --help.
  explicit Program(std::string_view verb, const std::string& details = {});
  // Defined in run.cpp, so that not every program compiles all of CLI11.
  ~Program() override;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
};

/// Thrown by an option that prints a text and ends the program, like --help.
class Printed : public CLI::Success {
public:
  explicit Printed(const std::string& text) : CLI::Success("Printed", text, CLI::ExitCodes::Success) {}
};

/// Accepts a number in this range. Unlike CLI::Range, refuses texts that are not numbers, such as nan.
CLI::Validator number_between(double min, double max = std::numeric_limits<double>::max());

/// Replaces a size with a unit, such as 0.5MB, 2 GiB or 1e6, by its number of bytes, which must be in this
/// range. 1 kB is 1000 bytes.
CLI::Validator size_between(double min_bytes, double max_bytes = 1e18);

/// Accepts a text, or the name of a file, that `read` reads without an exception.
CLI::Validator readable_by(std::function<void(const std::string&)> read);

/// Accepts an integer from 0 to `max`, such as a seed. Without a limit, CLI11 reads -1 as the largest number.
CLI::Validator natural_number(std::uint64_t max = 1'000'000'000);

/// Exit code for a file of settings or options that cannot be used: EX_CONFIG of sysexits.h. A service
/// manager need not try again.
inline constexpr int wrong_configuration = 78;
/// Exit code for a wrong value on the command line: one of CLI11's own. A service manager need not try again.
inline constexpr int wrong_option = static_cast<int>(CLI::ExitCodes::ValidationError);

/// Lets run() return this code instead of 0. For any thread.
void end_with(int code);

/// Parses the command line, with the options of a file (options_file.hpp), and runs `body`. Returns the exit
/// code: 0 for success, help and a stop by signal; CLI11's own numbers for errors of the command line;
/// `wrong_configuration` for config::ConfigError and for a wrong option of a file. In a program with a file
/// of options, which may be a service, std::invalid_argument is a mistake of its options: `wrong_option`.
/// Returns 1 for any other exception, even on another thread, and for a failed output. The reason goes to
/// stderr. For an unknown option or command, it names the nearest known one. Arguments of ROS 2
/// (`--ros-args … --`) are not used; parameters among them cause a warning.
int run(CLI::App& app, int argc, char** argv, const std::function<int()>& body);
/// The same for arguments without the name of the program.
int run(CLI::App& app, const std::vector<std::string>& arguments, const std::function<int()>& body);

/// Runs a node that other programs depend on. Throws the exception that ended it, with advice to restart.
void serve(const std::function<void()>& node);

}  // namespace sonopose::apps
