#pragma once
/// \file
/// Foreign text for a terminal.

#include <string>
#include <string_view>

namespace sonopose::text {

/// The text with control characters as `\x1b`: a terminal could take them for commands.
std::string escaped(std::string_view text);

}  // namespace sonopose::text
