#pragma once
// The text of --help.

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace sonopose::apps {

/// No line of a help is longer.
inline constexpr std::size_t help_columns = 100;

/// `text` in lines of at most `help_columns`, each after the first behind `indent` blanks. The first one
/// begins in column `begin`.
std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent);

/// Every line of a text that is too long, continued at `indent`.
std::string wrapped_lines(std::string_view text, std::size_t indent);

/// Everything if that fits a page; otherwise one line for each option, and --help-all has everything.
class HelpFormatter : public CLI::Formatter {
public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace sonopose::apps
