#pragma once
/// \file
/// Foreign text for a terminal.

#include <string>
#include <string_view>

namespace sonopose::text {

/// The text with control characters, those of C1 too, and bytes that are not UTF-8 as `\x1b`: a terminal
/// could take them for commands.
std::string escaped(std::string_view text);

}  // namespace sonopose::text
