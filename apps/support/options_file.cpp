#include "options_file.hpp"

#include "config/fusion_config.hpp"
#include "help.hpp"
#include "logging/log.hpp"
#include "run.hpp"
#include "toml/leaves.hpp"
#include "toml/quoted.hpp"
#include <sonopose/text/nearest.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

namespace sonopose::apps {
namespace {

constexpr const char* file_option = "--config";
constexpr const char* print_option = "--print-config";

/// Returns the file of the last --config; empty if there is none.
std::string file_in(const std::vector<std::string>& arguments) {
  const std::string joined = std::string(file_option) + "=";
  std::string file;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i].starts_with(joined)) file = arguments[i].substr(joined.size());
    if (arguments[i] == file_option && i + 1 < arguments.size()) file = arguments[i + 1];
  }
  return file;
}

/// True for an option without a value, or with one that may be absent, as --realtime.
bool may_stand_alone(const Option& option) {
  return option.max_values() == 0;
}

/// Returns the value of such an option that stands alone.
std::string value_alone(const Option& option) {
  return option.cli().get_flag_value(option.long_names().front(), "");
}

bool is_flag(const Option& option) {
  return may_stand_alone(option) && value_alone(option) == "true";
}

/// Returns the key of an option; empty if it is not one of the program.
std::string key_of(const CommandLine& app, const std::string& key) {
  if (!app.has_option("--set")) return key;
  return key.starts_with(config::program_prefix) ? key.substr(config::program_prefix.size()) : "";
}

std::vector<std::string> texts_of(const toml::Value& value) {
  if (const auto* const words = std::get_if<toml::Words>(&value)) return *words;
  if (const auto* const text = std::get_if<std::string>(&value)) return {*text};
  if (std::holds_alternative<toml::OtherValue>(value)) return {};
  return {toml::text_of(value)};
}

/// Returns the values for an option; none for a flag that is false, as if it were not given.
std::vector<std::string> values_for(const Option& option, const toml::Value& value) {
  const bool* const truth = std::get_if<bool>(&value);
  if (truth == nullptr || !may_stand_alone(option)) return texts_of(value);
  return *truth ? std::vector{value_alone(option)} : std::vector<std::string>{};
}

[[noreturn]] void refuse_key(const CommandLine& app, const std::string& origin, const std::string& key) {
  std::vector<std::string> known;
  for (const Option& option : app.options()) {
    if (is_key(option)) known.push_back(option.long_names().front());
  }
  throw config::ConfigError(
      fmt::format("{}: {} has no such option{}", origin, app.name(), text::suggestion(key, known)));
}

FileOption option_of(const CommandLine& app, const std::string& file, const toml::Leaf& leaf,
                     const std::string& key) {
  const std::string origin = fmt::format("{}:{}: {}", file, leaf.line, leaf.key);
  const std::string name = "--" + key;
  if (!app.has_option(name) || !is_key(app.option(name))) refuse_key(app, origin, key);
  const Option option = app.option(name);
  if (std::holds_alternative<toml::OtherValue>(leaf.value)) {
    throw config::ConfigError(origin + ": neither a number, true or false, a text, nor an array of those");
  }
  if (is_flag(option) && !std::holds_alternative<bool>(leaf.value)) {
    throw config::ConfigError(origin + ": must be true or false");
  }
  return {origin, name, values_for(option, leaf.value)};
}

/// Returns a value as TOML: numbers and truth values as they are, other texts in quotes.
std::string literal(const Option& option, const std::string& text) {
  double number = 0;
  const bool is_truth = is_flag(option) && (text == "true" || text == "false");
  const bool is_number = !text.empty() && text.find_first_not_of("-0123456789.") == std::string::npos &&
                         text.back() != '.' && text.front() != '.' &&
                         (text.size() == 1 || text.front() != '0' || text[1] == '.') &&
                         CLI::detail::lexical_cast(text, number);
  return is_truth || is_number ? text : toml::quoted(text);
}

std::string value_text(const Option& option) {
  std::vector<std::string> texts = option.results();
  if (texts.size() == 1) return literal(option, texts.front());
  for (std::string& text : texts) text = literal(option, text);
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// Returns what is allowed in brackets, as in --help, or else the type.
std::string allowed_text(const Option& option) {
  const std::string text = option.cli().get_option_text();
  if (!text.empty()) return fmt::format(" ({})", text.substr(0, text.find(" (")));
  const std::string values = allowed(option.cli());
  const std::string shown = values.empty() ? option.cli().get_type_name() : values;
  return shown.empty() ? "" : fmt::format(" ({})", shown);
}

/// Returns the value of an option that is not given; empty if there is none.
std::string default_text(const Option& option) {
  constexpr std::string_view mark = " (default: ";
  const std::string text = option.cli().get_option_text();
  const std::size_t begin = text.find(mark);
  if (begin == std::string::npos) return is_flag(option) ? "false" : option.default_text();
  return text.substr(begin + mark.size(), text.size() - begin - mark.size() - 1);
}

std::string comment(const std::string& text) {
  std::string lines = "# " + wrapped(text, 2, 0);
  for (std::size_t at = lines.find('\n'); at != std::string::npos; at = lines.find('\n', at + 1)) {
    lines.insert(at + 1, "# ");
  }
  return lines + "\n";
}

}  // namespace

void add_options_file(CommandLine& app, const std::string& group) {
  app.add_option(file_option, "TOML file with options, and its drop-ins FILE.d/*.toml")
      .type_name("FILE")
      .group(group);
  app.add_flag_callback(
         print_option, [app] { throw Printed(options_toml(app)); },
         "Print all options with what is given as commented TOML and exit")
      .group(group);
}

bool has_options_file(const CommandLine& app) {
  return app.has_option(file_option) && app.has_option(print_option);
}

bool is_key(const Option& option) {
  constexpr std::array others{"--help", "--help-all",      "--version",  file_option,
                              "--set",  "--help-settings", print_option, "--check-config"};
  if (option.long_names().empty() || option.group_name().empty()) return false;
  return std::ranges::none_of(others, [&](const char* name) { return option.has_name(name); });
}

bool is_given(const Option& option, const std::vector<std::string>& arguments) {
  return std::ranges::any_of(arguments, [&](const std::string& argument) {
    const std::string name = argument.substr(0, argument.find('='));
    return name.starts_with('-') && option.has_name(name);
  });
}

std::vector<FileOption> file_options(const CommandLine& app, const std::vector<std::string>& arguments) {
  const std::string file = file_in(arguments);
  if (!has_options_file(app) || file.empty()) return {};
  const bool has_settings = app.has_option("--set");  // whose reader warns
  if (!has_settings) {
    for (const std::string& text : toml::unread_drop_ins(file)) logging::warning(text);
  }
  std::map<std::string, FileOption> options;  // the last file with an option gives its value
  try {
    for (const auto& each : toml::with_drop_ins(file)) {
      for (const toml::Leaf& leaf : toml::read_leaves(each)) {
        const std::string key = key_of(app, leaf.key);
        if (key.empty()) continue;
        FileOption option = option_of(app, each.string(), leaf, key);
        if (!is_given(app.option(option.name), arguments)) {
          options.insert_or_assign(key, std::move(option));
        }
      }
    }
  } catch (const files::IoError& error) {
    throw config::ConfigError(error.what());
  }
  std::vector<FileOption> list;
  for (auto& entry : options) list.push_back(std::move(entry.second));
  return list;
}

void give(Option option, const std::vector<std::string>& values) {
  if (values.empty()) return;
  constexpr std::array truths{"true", "false", "yes", "no", "on", "off"};  // of YAML
  const auto is_truth = [&](const std::string& text) {
    return std::ranges::find(truths, CLI::detail::to_lower(text)) != truths.end();
  };
  if (is_flag(option) && !std::ranges::all_of(values, is_truth)) {
    refuse_option(option.name(), "must be true or false");
  }
  option.cli().clear();
  for (const std::string& value : values) option.cli().add_result(value);
}

void assign(Option option, const std::vector<std::string>& values) {
  try {
    give(option, values);
    if (!values.empty()) option.cli().run_callback();
  } catch (const CLI::ParseError& error) {
    throw std::invalid_argument(error.what());
  }
}

std::string options_toml(const CommandLine& app) {
  std::string text =
      comment(fmt::format("Options of {} for --config. Those of the command line replace them.", app.name()));
  for (const Option& option : app.options()) {
    if (!is_key(option)) continue;
    const std::string key = option.long_names().front();
    const bool is_set = option.count() > 0;
    std::string value = is_set ? value_text(option) : default_text(option);
    if (!is_set && !value.empty()) value = literal(option, value);
    text += "\n" + comment(option.cli().get_description() + allowed_text(option));
    text += fmt::format("{}{} = {}\n", is_set ? "" : "# ", key, value);
  }
  return text;
}

}  // namespace sonopose::apps
