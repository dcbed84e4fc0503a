#pragma once
/// \file
/// Quotes a text for TOML.

#include <string>

namespace sonopose::toml {

/// Returns any bytes as a quoted text on one line of valid UTF-8.
std::string quoted(std::string text);

}  // namespace sonopose::toml
