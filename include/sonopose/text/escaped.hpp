#pragma once
/// \file
/// Foreign text for a terminal.

#include <string>
#include <string_view>

namespace sonopose::text {

/// The text with control characters (also of C1), line separators, characters that change the direction of
/// text, and bytes that are not UTF-8 as `\x1b`: a terminal could take them for commands.
std::string escaped(std::string_view text);

/// Text or JSON of several lines for standard output: the same characters as `\u001b`, which JSON reads as
/// the character, and bytes that are not UTF-8 as U+FFFD. Line feeds and tabs remain, so escape the names in
/// a line before.
std::string printable(std::string_view text);

}  // namespace sonopose::text
