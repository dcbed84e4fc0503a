#pragma once
/// \file
/// A number for a reader.

#include <string>

namespace sonopose::text {

/// Returns the value with this number of decimals. One that rounds to zero has no sign: "0", not "-0".
std::string number_text(double value, int decimals);

}  // namespace sonopose::text
