#pragma once
/// \file
/// The plotting library of Debian's package libjs-dygraphs.

#include <string>

namespace sonopose::page {

/// The text of one of its files, such as "dygraph.min.js". Throws files::IoError that names the package if it
/// is not installed.
std::string library_file(const std::string& name);

}  // namespace sonopose::page
