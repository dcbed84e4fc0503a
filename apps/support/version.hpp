#pragma once
/// \file
/// The version of the project.

#include <string_view>

namespace sonopose::apps {

std::string_view version();

/// Text that --version prints after the name of a program: the version, and the C++ binding of sonopose::cxx.
std::string_view version_text();

}  // namespace sonopose::apps
