#pragma once
/// \file
/// Standard output of the programs.

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace sonopose::apps {

/// Writes text or JSON to standard output, without what a terminal could take for a command: names come from
/// the bus and from files. Escape those in a line of text (text::escaped), since line feeds remain.
void print_text(std::string_view text);

/// Formats, and prints as above.
template <class... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  print_text(fmt::format(format, std::forward<Values>(values)...));
}

/// Passes standard output to the operating system. Throws std::runtime_error with the cause of an error, even
/// of earlier output, such as a closed pipe or a full disk.
void flush_output();

}  // namespace sonopose::apps
