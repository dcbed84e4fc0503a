#include "run.hpp"

#include "completion.hpp"
#include "config/fusion_config.hpp"
#include "configuration_errors.hpp"
#include "help.hpp"
#include "logging/log.hpp"
#include "options_file.hpp"
#include "verbs.hpp"
#include "version.hpp"
#include <sonopose/text/nearest.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fcntl.h>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace sonopose::apps {
namespace {

static_assert(wrong_option == static_cast<int>(CLI::ExitCodes::ValidationError));

std::string description_of(std::string_view verb) {
  const auto* const found =
      std::find_if(verbs.begin(), verbs.end(), [&](const Verb& each) { return each.name == verb; });
  if (found == verbs.end()) throw std::logic_error(fmt::format("{}: not in verbs.hpp", verb));
  return std::string(found->description);
}

/// Returns the given command, or the program itself.
const CLI::App& command_of(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return given.empty() ? app : *given.front();
}

/// Returns every option that this command line allows, as "--name" or "-n".
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* each : {&app, &command_of(app)}) {
    for (const CLI::Option* option : each->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
  }
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

/// Says on which side of its command an option belongs; empty for an unknown option.
std::string right_place_of(const std::string& option, const CLI::App& app) {
  const CLI::App& command = command_of(app);
  if (&command == &app) return "";
  const std::string& name = command.get_name();
  if (command.get_option_no_throw(option) != nullptr) {
    return fmt::format("belongs after {1}: {2} {1} {0} …", option, name, app.get_name());
  }
  if (app.get_option_no_throw(option) == nullptr) return "";
  return fmt::format("belongs before {1}: {2} {0} {1}", option, name, app.get_name());
}

/// Describes the mistake in the command line. An unknown argument takes precedence, since it often causes
/// other mistakes.
std::string mistake_in(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining(true);
  const auto option = std::find_if(unknown.begin(), unknown.end(),
                                   [](const std::string& word) { return word.starts_with('-'); });
  if (option != unknown.end()) {
    const std::string name = option->substr(0, option->find('='));
    const std::string place = right_place_of(name, app);
    if (!place.empty()) return fmt::format("{}: {}", name, place);
    return fmt::format("{}: unknown option{}", name, text::suggestion(name, option_names(app)));
  }
  if (unknown.empty()) return error.what();
  const std::vector<std::string> commands = command_names(app);
  if (commands.empty() || !app.get_subcommands().empty()) {
    return fmt::format("{}: unexpected argument", unknown.front());
  }
  return fmt::format("{}: unknown command{}", unknown.front(), text::suggestion(unknown.front(), commands));
}

/// Joins an option and its optional value, which CLI11 would give to a required positional argument.
/// Separates an empty value, in place of which CLI11 would take the next word.
std::vector<std::string> with_joined_values(const CLI::App& app, const std::vector<std::string>& arguments) {
  std::vector<std::string> joined;
  bool takes_value = false;
  bool are_options = true;
  for (const std::string& argument : arguments) {
    are_options = are_options && argument != "--";
    if (are_options && argument.starts_with("--") && argument.find('=') + 1 == argument.size()) {
      const std::string name = argument.substr(0, argument.size() - 1);
      const CLI::Option* const option = app.get_option_no_throw(name);
      if (option == nullptr || option->get_items_expected_max() > 0) {
        joined.insert(joined.end(), {name, ""});
        takes_value = false;
        continue;
      }
    }
    if (takes_value && !argument.starts_with('-')) {
      joined.back() += "=" + argument;
      takes_value = false;
      continue;
    }
    joined.push_back(argument);
    const CLI::Option* const option = app.get_option_no_throw(argument);
    takes_value = option != nullptr && argument.starts_with('-') && option->get_items_expected_min() == 0 &&
                  option->get_items_expected_max() == 1;
  }
  return joined;
}

/// True if a text has this name of an option, not only as a part of a longer name.
bool names(const std::string& text, const std::string& option) {
  const std::size_t end = text.find(option) + option.size();
  return end >= option.size() &&
         (end >= text.size() || std::string_view(" :,").find(text[end]) != std::string_view::npos);
}

/// Returns where a mistake is, if it is in a file.
std::string origin_of(const std::exception& error, const std::vector<FileOption>& options) {
  const std::string text = error.what();
  const auto found =
      std::ranges::find_if(options, [&](const FileOption& option) { return names(text, option.name); });
  return found == options.end() ? "" : found->origin + ": ";
}

/// Prints a requested text. Returns the exit code.
int print_requested(const std::string& text) {
  try {
    print_text(text);
    flush_output();
    return 0;
  } catch (const std::exception& error) {
    logging::failure(error.what());
    return 1;
  }
}

/// Makes a limit of the file size (ulimit -f, LimitFSIZE=) an error of the write instead of the end of the
/// process. Keeps closed standard streams from being taken by the next files, which would then receive what
/// is printed; writing to such a stream stays an error.
void prepare_process() {
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    ::open("/dev/null",
           stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // takes the lowest number that is free
  }
}

/// Throws CLI::ValidationError for an empty or blank path, which mostly is an unset variable of a shell.
void refuse_empty_paths(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string all = option->get_type_name();  // followed by those of its checks
    const std::string type = all.substr(0, all.find(':'));
    if (type != "FILE" && type != "DIR" && type != "PATH") continue;
    const auto& values = option->results();
    const auto is_blank = [](const std::string& path) {
      return path.find_first_not_of(" \t\r\n") == std::string::npos;
    };
    const auto blank = std::find_if(values.begin(), values.end(), is_blank);
    if (blank == values.end()) continue;
    throw CLI::ValidationError(option->get_name(),
                               blank->empty() ? "the path is empty" : "the path is blank");
  }
}

/// Returns the text of an error, with the limit behind one that only names a shortage.
std::string reason_of(const std::exception& error) {
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  if (system == nullptr || system->code() != std::errc::resource_unavailable_try_again) return error.what();
  return fmt::format(
      "{}: too few processes and threads may start (ulimit -u; TasksMax= of a service; "
      "--pids-limit of a container)",
      error.what());
}

/// The arguments of a ROS 2 node, which launch_ros appends to those of any program.
struct RosArguments {
  std::string text;  ///< without "--ros-args"
  bool has_parameters = false;
};

/// Removes `--ros-args … --`.
std::vector<std::string> without_ros_arguments(const std::vector<std::string>& arguments,
                                               RosArguments& removed) {
  std::vector<std::string> own;
  bool is_ros = false;
  for (const std::string& word : arguments) {
    if (word == "--ros-args") {
      is_ros = true;
    } else if (!is_ros) {
      own.push_back(word);
    } else if (word == "--") {
      is_ros = false;
    } else {
      removed.text.append(removed.text.empty() ? "" : " ").append(word);
      removed.has_parameters |= word == "-p" || word == "--param" || word == "--params-file";
    }
  }
  return own;
}

/// The name for exceptions of other threads. Set once, before there are any.
std::string& program_name() {
  static std::string name;
  return name;
}

std::atomic<bool> is_serving = false;

std::atomic<int> code_of_success = 0;

/// Set once, before the command line is parsed.
std::function<bool(const std::exception&)>& is_foreign_configuration_error() {
  static std::function<bool(const std::exception&)> is_one;
  return is_one;
}

bool is_configuration_error(const std::exception& error) {
  const auto& is_foreign = is_foreign_configuration_error();
  return dynamic_cast<const config::ConfigError*>(&error) != nullptr || (is_foreign && is_foreign(error));
}

/// Reports the error that ended a program. Returns the exit code.
int report_end(const std::exception& error, const CommandLine& program,
               const std::vector<FileOption>& of_file) {
  const auto* const of_parser = dynamic_cast<const CLI::ParseError*>(&error);
  const bool is_mistake =
      of_parser != nullptr || dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
  const bool is_of_configuration = is_configuration_error(error);
  const std::string origin = is_mistake || is_of_configuration ? origin_of(error, of_file) : "";
  logging::failure(origin + reason_of(error));
  if (!origin.empty() || is_of_configuration) return wrong_configuration;
  if (!is_mistake || !has_options_file(program)) return 1;
  return of_parser != nullptr ? of_parser->get_exit_code() : wrong_option;
}

std::string restart_words() {
  return fmt::format("restart {}; no other program needs a restart", program_name());
}

/// Ends the program after an uncaught exception of another thread.
[[noreturn]] void end_by_exception() {
  std::string reason = "ended by an error without a description";
  try {
    if (const auto exception = std::current_exception()) std::rethrow_exception(exception);
  } catch (const std::exception& error) {
    reason = reason_of(error);
  } catch (...) {  // NOLINT(bugprone-empty-catch): keep the text above
  }
  if (is_serving) reason += "; " + restart_words();
  logging::failure(reason);
  std::_Exit(1);
}

}  // namespace

Program::Program(std::string_view verb, const std::string& details)
    : Program(std::make_unique<CLI::App>(description_of(verb) + (details.empty() ? "" : "\n" + details),
                                         fmt::format("sonopose-{}", verb))) {
  const auto help = std::make_shared<HelpFormatter>();
  help->label("SUBCOMMAND", "COMMAND");
  app_->formatter(help);  // later commands inherit it
  app_->set_help_all_flag("--help-all", "Print everything about every option and exit");
  app_->set_version_flag("--version", name() + " " + std::string(apps::version_text()),
                         "Print the version and exit");
  add_completions(*app_);
}

Program::Program(std::unique_ptr<CLI::App> app) : CommandLine(*app), app_(std::move(app)) {}

Program::~Program() = default;

void count_as_configuration_error(std::function<bool(const std::exception&)> is_one) {
  is_foreign_configuration_error() = std::move(is_one);
}

void end_with(int code) {
  code_of_success = code;
}

void serve(const std::function<void()>& node) {
  is_serving = true;
  try {
    node();
  } catch (const std::exception& error) {
    is_serving = false;
    throw std::runtime_error(fmt::format("{}; {}", reason_of(error), restart_words()));
  }
  is_serving = false;
}

int run(Program& program, int argc, char** argv, const std::function<int()>& body) {
  RosArguments ros;
  const auto arguments = without_ros_arguments({argv + 1, argv + argc}, ros);
  return run(program, arguments, [&] {
    if (ros.has_parameters) {
      logging::warning(fmt::format("not used: {}; only sonopose-ros2 reads parameters of ROS 2", ros.text));
    } else if (!ros.text.empty()) {
      logging::info(fmt::format("not used: {}; this program is no ROS 2 node", ros.text));
    }
    return body();
  });
}

int run(Program& program, const std::vector<std::string>& arguments, const std::function<int()>& body) {
  CLI::App& app = program.cli();
  program_name() = app.get_name();
  logging::set_program(app.get_name());
  prepare_process();
  std::vector<FileOption> of_file;
  try {
    of_file = file_options(program, arguments);
    for (const FileOption& each : of_file) give(program.option(each.name), each.values);
    std::vector<std::string> words = with_joined_values(app, arguments);
    std::reverse(words.begin(), words.end());  // CLI11 takes arguments in reverse order
    app.parse(std::move(words));
    for (const CLI::App* each : {&std::as_const(app), &command_of(app)}) refuse_empty_paths(*each);
  } catch (const Printed& asked) {
    return print_requested(asked.what());
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text);
    return print_requested(text.str());
  } catch (const CLI::ParseError& error) {
    const std::string origin = app.remaining(true).empty() ? origin_of(error, of_file) : "";
    logging::failure(fmt::format("{}{}\nRun {} --help for more information.", origin, mistake_in(app, error),
                                 app.get_name()));
    return origin.empty() ? error.get_exit_code() : wrong_configuration;
  } catch (const std::exception& error) {
    return report_end(error, program, of_file);
  }
  std::set_terminate(end_by_exception);
  try {
    const int code = body();
    flush_output();
    return code == 0 ? code_of_success.load() : code;
  } catch (const std::exception& error) {
    return report_end(error, program, of_file);
  }
}

}  // namespace sonopose::apps
