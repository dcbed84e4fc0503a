#pragma once
/// \file
/// Errors about paths that a user has given.

#include <filesystem>
#include <string>

namespace sonopose::files {

/// Returns "NAME: does not exist", or "NAME: cannot be opened: REASON" for another `error` of errno.
std::string opening_error(const std::string& name, int error);

/// Throws IoError if there is no such folder, or if something else has its name.
void require_folder(const std::filesystem::path& folder);

/// Returns true if a file or folder has this name. Throws IoError if that is unknown, for example in a folder
/// without access.
bool is_present(const std::filesystem::path& path);

}  // namespace sonopose::files
