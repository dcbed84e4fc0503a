#pragma once
// The start and end of every program, with or without the bus.

#include "command_line.hpp"
#include "output.hpp"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::apps {

/// The command line of the program sonopose-VERB: name, description (verbs.hpp) and --version.
class Program : public CommandLine {
public:
  /// `details` follow the description in --help.
  explicit Program(std::string_view verb, const std::string& details = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

private:
  explicit Program(std::unique_ptr<CLI::App> app);

  std::unique_ptr<CLI::App> app_;
};

/// Exit code for a file of settings or options that cannot be used: EX_CONFIG of sysexits.h. A service
/// manager need not try again.
inline constexpr int wrong_configuration = 78;
/// Exit code for a wrong value on the command line: one of CLI11's own. A service manager need not try again.
inline constexpr int wrong_option = 105;

/// Lets run() return this code instead of 0. For any thread.
void end_with(int code);

/// Parses the command line, with the options of a file (options_file.hpp), and runs `body`. Returns the exit
/// code: 0 for success, help and a stop by signal; CLI11's own numbers for errors of the command line;
/// `wrong_configuration` for config::ConfigError and for a wrong option of a file. In a program with a file
/// of options, which may be a service, std::invalid_argument is a mistake of its options: `wrong_option`.
/// Returns 1 for any other exception, even on another thread, and for a failed output. The reason goes to
/// stderr. For an unknown option or command, it names the nearest known one. Arguments of ROS 2
/// (`--ros-args … --`) are not used; parameters among them cause a warning.
int run(Program& program, int argc, char** argv, const std::function<int()>& body);
/// The same for arguments without the name of the program.
int run(Program& program, const std::vector<std::string>& arguments, const std::function<int()>& body);

/// Runs a node that other programs depend on. Throws the exception that ended it, with advice to restart.
void serve(const std::function<void()>& node);

}  // namespace sonopose::apps
