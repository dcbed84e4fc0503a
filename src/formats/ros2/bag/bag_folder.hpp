#pragma once
/// \file
/// The folder of a rosbag2 recording.

#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

/// Returns true for a folder with rosbag2's metadata.yaml, or with SQLite files, which is no log folder.
bool is_bag_folder(const std::filesystem::path& folder);

/// Returns its SQLite files, by name: bag_9.db3 before bag_10.db3.
std::vector<std::filesystem::path> sqlite_files_in(const std::filesystem::path& folder);

/// Describes the files that metadata.yaml lists and that are missing. Throws files::IoError if it is
/// unreadable, or if the recording is compressed file by file.
std::vector<std::string> missing_files(const std::filesystem::path& folder);

}  // namespace sonopose::ros2::bag
