#pragma once
/// \file
/// A text as TOML has it.

#include <string>

namespace sonopose::files::toml {

/// In quotes, on one line of valid UTF-8, whatever bytes it contains.
std::string quoted(std::string text);

}  // namespace sonopose::files::toml
