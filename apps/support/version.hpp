#pragma once
/// \file
/// The version of the project.

#include <string_view>

namespace sonopose::apps {

/// Such as 0.1.0.
std::string_view version();

}  // namespace sonopose::apps
