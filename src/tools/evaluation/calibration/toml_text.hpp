#pragma once
/// \file
/// Writes values and comments of the TOML files that calibrations produce.

#include <string>

namespace sonopose::evaluation {

/// Writes a float that reads back to the same bits. It has a decimal point or an exponent; otherwise TOML
/// takes it for an integer.
std::string toml_number(double value);

/// Writes the text as comments. TOML allows no control characters in comments.
std::string commented(const std::string& text);

}  // namespace sonopose::evaluation
