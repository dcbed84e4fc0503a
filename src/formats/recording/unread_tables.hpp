#pragma once
/// \file
/// Files of a log folder that no program reads.

#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::recording {

/// Returns a text about tables that are not read, as those with a wrong name. Files of replays are known.
std::vector<std::string> unread_tables(const std::filesystem::path& folder);

}  // namespace sonopose::recording
