#pragma once
/// \file
/// Errors of paths that a user has given.

#include <filesystem>
#include <string>

namespace sonopose::files {

/// "NAME: does not exist", or "NAME: cannot be opened: REASON" for another `error` of errno.
std::string opening_error(const std::string& name, int error);

/// Throws IoError if there is no such folder, and says whether something else has its name.
void require_folder(const std::filesystem::path& folder);

/// Whether there is something of this name. Throws IoError if that cannot be known, for example in a folder
/// that may not be entered.
bool is_present(const std::filesystem::path& path);

}  // namespace sonopose::files
