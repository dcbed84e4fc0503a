#pragma once
// How every program begins and ends, with the bus or without it.

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

/// Thrown by an option that prints a text and ends the program, as --help does.
class Printed : public CLI::Success {
public:
  explicit Printed(const std::string& text) : CLI::Success("Printed", text, CLI::ExitCodes::Success) {}
};

/// A number between the two; unlike CLI::Range it refuses what is no number, such as nan.
CLI::Validator number_between(double least, double most = std::numeric_limits<double>::max());

/// A whole number from 0 to 10⁹, such as a seed. Without a limit CLI11 reads -1 as the largest number.
CLI::Validator natural_number();

/// Parses the command line and runs `body`. Returns the exit code: 0 for success, help and a stop by signal;
/// the command line's own errors as CLI11 numbers them; 1 for any exception, also on another thread, and for
/// an output that cannot be written. The reason goes to stderr; for an unknown option or command it names the
/// nearest known one.
int run(CLI::App& app, int argc, char** argv, const std::function<int()>& body);
/// The same for arguments without the name of the program.
int run(CLI::App& app, const std::vector<std::string>& arguments, const std::function<int()>& body);

/// Runs the node of a program whose other programs depend on it. Throws what ended it, with the restart that
/// helps.
void serve(const std::function<void()>& node);

/// Parses arguments, and those of another source after them. Throws CLI::ParseError.
void parse(CLI::App& app, std::vector<std::string> arguments, const std::vector<std::string>& more = {});

}  // namespace sonopose::apps
