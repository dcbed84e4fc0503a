#include "help.hpp"

#include <sonopose/text/columns_of.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

namespace sonopose::apps {
namespace {

constexpr std::size_t page_lines = 45;
constexpr std::size_t left_columns = 30;

using text::columns_of;

std::string row(const std::string& left, const std::string& right) {
  const std::string indented = "  " + left;
  if (columns_of(indented) + 1 < left_columns) {
    return fmt::format("{:<{}}{}\n", indented, left_columns, wrapped(right, left_columns, left_columns));
  }
  const std::string name = wrapped(indented, 0, 4) + "\n";
  if (right.empty()) return name;
  return name + std::string(left_columns, ' ') + wrapped(right, left_columns, left_columns) + "\n";
}

/// Returns the beginning of a description that fits on one line, if possible up to the end of a clause. "…"
/// marks the omission.
std::string brief(const std::string& text, std::size_t columns) {
  if (columns_of(text) <= columns) return text;
  const std::string mark = " …";
  const std::size_t most = columns - columns_of(mark);
  for (const std::vector<std::string>& ends : {std::vector<std::string>{"; ", " ("}, {": ", ", "}, {" "}}) {
    std::size_t cut = std::string::npos;
    for (const std::string& end : ends) {
      const std::size_t found = text.rfind(end, most);
      if (found != std::string::npos && (cut == std::string::npos || found > cut)) cut = found;
    }
    if (cut == std::string::npos || cut == 0) continue;
    const std::string begin = text.substr(0, cut);
    const std::size_t opened = begin.rfind(" (");
    const bool is_open = opened != std::string::npos && begin.find(')', opened) == std::string::npos;
    return (is_open ? text.substr(0, opened) : begin) + mark;
  }
  return text;
}

/// Returns "N" for "UINT:[0 - 65534]", and no default.
std::string short_type(const CLI::Option& option) {
  const std::string& text = option.get_option_text();
  if (!text.empty()) return text.substr(0, text.find(" ("));
  const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
  const std::string first = type.substr(0, type.find(':'));
  if (first == "INT" || first == "UINT") return "N";
  return first == "FLOAT" ? "X" : first;
}

}  // namespace

std::string allowed(const CLI::Option& option) {
  if (!option.get_option_text().empty() || option.get_type_size() == 0) return {};
  const std::string type = option.get_type_name();
  const std::size_t opened = type.find_first_of("[{", std::min(type.find(':'), type.size()));
  if (opened == std::string::npos) return {};
  std::string text = type.substr(opened + 1, type.find_first_of("]}", opened) - opened - 1);
  const auto replace = [&text](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
  };
  if (type[opened] == '[') {
    replace(" - ", " … ");
  } else {
    replace(",", ", ");
  }
  return text;
}

namespace {

std::string names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : options) names.push_back(option->get_name());
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Returns the description with the details that it omits: "(1 … 65535; default: 256; not with --lossless)".
std::string whole_description(const CLI::Option& option) {
  std::vector<std::string> details;
  const std::string& text = option.get_option_text();
  if (const std::size_t opened = text.find(" ("); opened != std::string::npos) {
    details.push_back(text.substr(opened + 2, text.rfind(')') - opened - 2));
  }
  std::string description = option.get_description();
  const std::string values = allowed(option);
  if (description.find(values) == std::string::npos) details.push_back(values);
  if (!option.get_default_str().empty() && text.empty()) {
    details.push_back("default: " + option.get_default_str());
  }
  if (!option.get_needs().empty()) details.push_back("needs " + names_of(option.get_needs()));
  if (!option.get_excludes().empty()) details.push_back("not with " + names_of(option.get_excludes()));
  if (details.empty()) return description;
  if (!description.ends_with(')')) return fmt::format("{} ({})", description, fmt::join(details, "; "));
  description.pop_back();
  return fmt::format("{}; {})", description, fmt::join(details, "; "));
}

std::string brief_option(const CLI::Option& option) {
  const std::string name =
      option.get_positional() ? option.get_name(true, false) : option.get_name(false, true);
  std::string left = name + (short_type(option).empty() ? "" : " " + short_type(option));
  if (left.size() + 3 >= left_columns) left = name + " …";
  constexpr std::size_t columns = help_columns - left_columns;
  std::string right = brief(option.get_description(), columns);
  const std::string initial = option.get_default_str();
  const std::string with_default = fmt::format("{} (default: {})", right, initial);
  if (!initial.empty() && columns_of(with_default) <= columns) right = with_default;
  return fmt::format("  {:<{}}{}\n", left, left_columns - 2, right);
}

class Help {
public:
  Help(const CLI::App& app, const CLI::Formatter& formatter, bool is_brief)
      : app_(app), formatter_(formatter), brief_(is_brief) {}

  std::string text(const std::string& name) const {
    std::string text = wrapped_lines(app_.get_description(), 0) + "\n";
    text += wrapped_lines(formatter_.make_usage(&app_, name), 4);
    text += group("Positionals", [](const CLI::Option& option) { return option.get_positional(); });
    for (const std::string& each : app_.get_groups()) {
      if (each.empty()) continue;
      text += group(each, [&](const CLI::Option& option) {
        return option.get_group() == each && option.nonpositional() && !(brief_ && is_left_out(option));
      });
    }
    text += commands();
    if (brief_) text += "--help-all shows these in full, and rare options; --version shows the version.\n";
    return text;
  }

private:
  /// True for options of all programs, and rare ones, which --help-all alone shows.
  bool is_left_out(const CLI::Option& option) const {
    const auto is_deviation = [](const std::string& name) { return name.ends_with("-std"); };
    return std::any_of(option.get_lnames().begin(), option.get_lnames().end(), is_deviation) ||
           option.check_name("--enclave") || option.check_name("--services") ||
           option.check_name("--imu-meaning") || option.check_name("--max-beacons") ||
           &option == app_.get_help_ptr() || &option == app_.get_help_all_ptr() ||
           option.check_name("--version") || option.check_name("--print-config") ||
           option.check_name("--interface") || option.check_name("--partition") ||
           option.check_name("--qos") || option.check_name("--security");
  }

  template <class Takes>
  std::string group(const std::string& title, const Takes& takes) const {
    std::string rows;
    for (const CLI::Option* option : app_.get_options()) {
      if (option->get_group().empty() || !takes(*option)) continue;
      if (brief_) {
        rows += brief_option(*option);
      } else {
        std::string left =
            option->get_positional() ? option->get_name(true, false) : option->get_name(false, true);
        if (const std::string type = short_type(*option); !type.empty()) left.append(" ").append(type);
        rows += row(left, whole_description(*option));
      }
    }
    return rows.empty() ? rows : (brief_ ? "" : "\n") + title + ":\n" + rows;
  }

  std::string commands() const {
    std::string rows;
    for (const CLI::App* command : app_.get_subcommands(nullptr)) {
      rows += row(command->get_name(), command->get_description());
    }
    return rows.empty() ? rows : "\nCommands (COMMAND --help shows its options):\n" + rows;
  }

  const CLI::App& app_;
  const CLI::Formatter& formatter_;
  bool brief_;
};

}  // namespace

std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent) {
  std::string result;
  std::size_t column = begin;
  bool at_begin = true;
  const std::size_t blanks = std::min(text.find_first_not_of(' '), text.size());
  result.append(blanks, ' ');
  column += blanks;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word; at_begin = false) {
    if (!at_begin && column + 1 + columns_of(word) > help_columns) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!at_begin) {
      result += ' ';
      ++column;
    }
    result += word;
    column += columns_of(word);
  }
  return result;
}

std::string wrapped_lines(std::string_view text, std::size_t indent) {
  std::string result;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    result += (columns_of(line) <= help_columns ? line : wrapped(line, 0, indent)) + "\n";
  }
  return result;
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  const std::string whole = Help(*app, *this, false).text(name);
  const bool fits = std::count(whole.begin(), whole.end(), '\n') <= static_cast<std::ptrdiff_t>(page_lines);
  return fits || mode == CLI::AppFormatMode::All ? whole : Help(*app, *this, true).text(name);
}

}  // namespace sonopose::apps
