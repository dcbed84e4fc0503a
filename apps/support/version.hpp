#pragma once
/// \file
/// The version of the project.

#include <string_view>

namespace sonopose::apps {

std::string_view version();

}  // namespace sonopose::apps
