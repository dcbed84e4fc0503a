#pragma once
/// \file
/// The version of the project.

#include <string_view>

namespace sonopose::apps {

std::string_view version();

/// What --version prints after the name of a program: the version, and whose C++ binding sonopose::cxx is.
std::string_view version_text();

}  // namespace sonopose::apps
