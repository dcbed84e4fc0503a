#pragma once
/// \file
/// The plotting library of Debian's package libjs-dygraphs.

#include <string>

namespace sonopose::web {

/// Reads one of its files, such as "dygraph.min.js". Throws files::IoError that names the package if it is
/// not installed.
std::string dygraphs_file(const std::string& name);

}  // namespace sonopose::web
