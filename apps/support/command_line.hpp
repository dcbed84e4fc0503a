#pragma once
// The options of a program. CLI11 parses them; since it takes a compiler several seconds for each file that
// includes it, only the sources of sonopose_app_run do.

#include "checks.hpp"

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
class Option;
}  // namespace CLI

namespace sonopose::apps {

/// Throws the error of a command line with a wrong value of this option.
[[noreturn]] void refuse_option(const std::string& name, const std::string& mistake);
[[noreturn]] void refuse_command_line(const std::string& mistake);
/// Throws the error of a command line without this option.
[[noreturn]] void require_option(const std::string& name);

/// Thrown by an option that prints a text and ends the program, like --help.
class Printed : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Any number of values, for Option::expected.
inline constexpr int any_number = 1 << 29;

/// A handle of one option, valid as long as the Program. Its setters return it.
class Option {
public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option check(const Check& check);
  /// Lets `check` replace the text before other checks see it.
  Option transform(const Check& check);
  Option description(const std::string& text);
  Option type_name(const std::string& name);
  /// Replaces the type, range and default in --help.
  Option option_text(const std::string& text);
  Option group(const std::string& name);
  /// Shows the present value of the variable as the default.
  Option capture_default_str();
  Option default_str(const std::string& text);
  Option required();
  Option needs(Option other);
  Option excludes(Option other);
  Option expected(int count);
  Option expected(int min, int max);
  /// Lets one mention of the option take all words that follow, or a single one.
  Option allow_extra_args(bool value);
  Option delimiter(char value);
  Option envname(const std::string& name);
  Option each(const std::function<void(const std::string&)>& function);
  Option trigger_on_parse();

  [[nodiscard]] std::string name() const;         ///< such as --name or NAME
  [[nodiscard]] std::string single_name() const;  ///< without dashes
  [[nodiscard]] bool has_name(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> long_names() const;  ///< without "--"
  [[nodiscard]] std::string group_name() const;
  [[nodiscard]] std::string default_text() const;
  [[nodiscard]] int max_values() const;
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] std::vector<std::string> results() const;

  [[nodiscard]] CLI::Option& cli() const { return *option_; }

private:
  CLI::Option* option_;
};

/// A handle of the options and commands of a Program, or of one of its commands, valid as long as that
/// Program.
class CommandLine {
public:
  explicit CommandLine(CLI::App& app) : app_(&app) {}

  /// Adds an option that sets `value`, which must outlive the parsing. For the types at the end of
  /// command_line.cpp.
  template <class Value>
  Option add_option(const std::string& name, Value& value, const std::string& help);
  template <class Value>
  Option add_option_function(const std::string& name, const std::function<void(const Value&)>& set,
                             const std::string& help);
  /// Adds an option whose value is only checked.
  Option add_option(const std::string& name, const std::string& help);
  template <class Value>
  Option add_flag(const std::string& name, Value& value, const std::string& help);
  /// Adds a flag that calls `function`, which may throw Printed.
  Option add_flag_callback(const std::string& name, const std::function<void()>& function,
                           const std::string& help = {});
  CommandLine add_subcommand(const std::string& name, const std::string& help);

  /// Sets the group of the options that are added from now on.
  void set_default_group(const std::string& name);
  /// Lets the options of the program follow the command, too.
  void fallthrough();
  void require_subcommand();
  /// Calls `function` when all options are parsed.
  void final_callback(const std::function<void()>& function);

  [[nodiscard]] bool parsed() const;  ///< true for a command that is given
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::size_t count(const std::string& option) const;
  [[nodiscard]] bool has_option(const std::string& name) const;
  /// Throws std::exception for an unknown name.
  [[nodiscard]] Option option(const std::string& name) const;
  [[nodiscard]] std::vector<Option> options() const;

  [[nodiscard]] CLI::App& cli() const { return *app_; }

private:
  CLI::App* app_;
};

}  // namespace sonopose::apps
