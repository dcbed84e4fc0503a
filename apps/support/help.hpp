#pragma once
// The text of --help.

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace sonopose::apps {

/// Greatest length of a line of help.
inline constexpr std::size_t help_columns = 100;

/// Wraps `text` into lines of at most `help_columns`. The first one begins in column `begin`, the others
/// follow `indent` blanks.
std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent);

/// Wraps every overlong line of a text, and continues it at `indent`.
std::string wrapped_lines(std::string_view text, std::size_t indent);

/// Describes allowed values: "1 … 65535" for "N:[1 - 65535]", "0 or more", "documented, kalman".
std::string allowed(const CLI::Option& option);

/// Shows everything if it fits on a page. Otherwise shows one line per option, and --help-all shows
/// everything.
class HelpFormatter : public CLI::Formatter {
public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace sonopose::apps
