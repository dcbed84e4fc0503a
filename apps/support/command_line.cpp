#include "command_line.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>

namespace sonopose::apps {
namespace {

CLI::Validator validator_of(const Check& check) {
  return {check.mistake_in, check.allowed};
}

template <class Value>
struct IsWhole : std::is_integral<Value> {};
template <class Value>
struct IsWhole<std::optional<Value>> : std::is_integral<Value> {};

/// Names the mistake that CLI11 only calls impossible to convert.
std::string mistake_in_whole_number(const std::string& text) {
  std::int64_t value = 0;
  return CLI::detail::lexical_cast(text, value) ? "" : "'" + text + "' is not a whole number";
}

}  // namespace

void refuse_option(const std::string& name, const std::string& mistake) {
  throw CLI::ValidationError(name, mistake);
}

void refuse_command_line(const std::string& mistake) {
  throw CLI::ValidationError(mistake);
}

void require_option(const std::string& name) {
  throw CLI::RequiredError(name);
}

Option Option::check(const Check& check) {
  option_->check(validator_of(check));
  return *this;
}

Option Option::transform(const Check& check) {
  option_->transform(validator_of(check));
  return *this;
}

Option Option::description(const std::string& text) {
  option_->description(text);
  return *this;
}

Option Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option Option::option_text(const std::string& text) {
  option_->option_text(text);
  return *this;
}

Option Option::group(const std::string& name) {
  option_->group(name);
  return *this;
}

Option Option::capture_default_str() {
  option_->capture_default_str();
  return *this;
}

Option Option::default_str(const std::string& text) {
  option_->default_str(text);
  return *this;
}

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}

Option Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}

Option Option::expected(int count) {
  option_->expected(count);
  return *this;
}

Option Option::expected(int min, int max) {
  option_->expected(min, max);
  return *this;
}

Option Option::allow_extra_args(bool value) {
  option_->allow_extra_args(value);
  return *this;
}

Option Option::delimiter(char value) {
  option_->delimiter(value);
  return *this;
}

Option Option::envname(const std::string& name) {
  option_->envname(name);
  return *this;
}

Option Option::each(const std::function<void(const std::string&)>& function) {
  option_->each(function);
  return *this;
}

Option Option::trigger_on_parse() {
  option_->trigger_on_parse();
  return *this;
}

std::string Option::name() const {
  return option_->get_name();
}

std::string Option::single_name() const {
  return option_->get_single_name();
}

bool Option::has_name(const std::string& name) const {
  return option_->check_name(name);
}

std::vector<std::string> Option::long_names() const {
  return option_->get_lnames();
}

std::string Option::group_name() const {
  return option_->get_group();
}

std::string Option::default_text() const {
  return option_->get_default_str();
}

int Option::max_values() const {
  return option_->get_items_expected_max();
}

std::size_t Option::count() const {
  return option_->count();
}

std::vector<std::string> Option::results() const {
  return option_->results();
}

template <class Value>
Option CommandLine::add_option(const std::string& name, Value& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(name, value, help);
  if constexpr (IsWhole<Value>::value) option->check(mistake_in_whole_number);
  return Option(*option);
}

template <class Value>
Option CommandLine::add_option_function(const std::string& name, const std::function<void(const Value&)>& set,
                                        const std::string& help) {
  CLI::Option* const option = app_->add_option_function<Value>(name, set, help);
  if constexpr (IsWhole<Value>::value) option->check(mistake_in_whole_number);
  return Option(*option);
}

Option CommandLine::add_option(const std::string& name, const std::string& help) {
  return Option(*app_->add_option(name, help));
}

template <class Value>
Option CommandLine::add_flag(const std::string& name, Value& value, const std::string& help) {
  return Option(*app_->add_flag(name, value, help));
}

Option CommandLine::add_flag_callback(const std::string& name, const std::function<void()>& function,
                                      const std::string& help) {
  return Option(*app_->add_flag_callback(name, function, help));
}

CommandLine CommandLine::add_subcommand(const std::string& name, const std::string& help) {
  return CommandLine(*app_->add_subcommand(name, help));
}

void CommandLine::set_default_group(const std::string& name) {
  app_->option_defaults()->group(name);
}

void CommandLine::fallthrough() {
  app_->fallthrough();
}

void CommandLine::require_subcommand() {
  app_->require_subcommand(1);
}

void CommandLine::final_callback(const std::function<void()>& function) {
  app_->final_callback(function);
}

bool CommandLine::parsed() const {
  return app_->parsed();
}

std::string CommandLine::name() const {
  return app_->get_name();
}

std::size_t CommandLine::count(const std::string& option) const {
  return app_->count(option);
}

bool CommandLine::has_option(const std::string& name) const {
  return app_->get_option_no_throw(name) != nullptr;
}

Option CommandLine::option(const std::string& name) const {
  return Option(*app_->get_option(name));
}

std::vector<Option> CommandLine::options() const {
  std::vector<Option> options;
  for (CLI::Option* const option : app_->get_options([](CLI::Option*) { return true; }))
    options.emplace_back(*option);
  return options;
}

template Option CommandLine::add_option(const std::string&, int&, const std::string&);
template Option CommandLine::add_option(const std::string&, double&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::uint16_t&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::uint16_t>&,
                                        const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::uint64_t>&,
                                        const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::filesystem::path>&,
                                        const std::string&);
template Option CommandLine::add_option(const std::string&, std::array<double, 6>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<std::filesystem::path>&,
                                        const std::string&);
template Option CommandLine::add_flag(const std::string&, bool&, const std::string&);
template Option CommandLine::add_flag(const std::string&, int&, const std::string&);
template Option CommandLine::add_option_function(const std::string&,
                                                 const std::function<void(const double&)>&,
                                                 const std::string&);
template Option CommandLine::add_option_function(const std::string&,
                                                 const std::function<void(const std::uint32_t&)>&,
                                                 const std::string&);
template Option CommandLine::add_option_function(const std::string&,
                                                 const std::function<void(const std::string&)>&,
                                                 const std::string&);
template Option CommandLine::add_option_function(const std::string&,
                                                 const std::function<void(const std::vector<std::string>&)>&,
                                                 const std::string&);

}  // namespace sonopose::apps
