#pragma once
/// \file
/// A duration for a reader.

#include <string>

namespace sonopose::text {

/// Returns "45.0 s", "12.4 min", "3.1 h", "2.5 d" or "56.9 years": the largest unit that it has twice.
std::string duration_text(double duration_s);

}  // namespace sonopose::text
