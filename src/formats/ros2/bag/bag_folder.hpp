#pragma once
/// \file
/// The folder of a rosbag2 recording.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

/// Returns true for a folder with rosbag2's metadata.yaml, or with SQLite files, which is no log folder.
bool is_bag_folder(const std::filesystem::path& folder);

/// Returns its SQLite files, by name: bag_9.db3 before bag_10.db3.
std::vector<std::filesystem::path> sqlite_files_in(const std::filesystem::path& folder);

/// Files and messages of a folder, by its metadata.yaml.
struct Metadata {
  std::vector<std::filesystem::path> files{};  ///< those that it lists and that are there, normal
  std::vector<std::string> missing{};          ///< descriptions of those that are not there, or compressed
  std::uint64_t messages = 0;                  ///< number of all messages; 0 if it does not say
};

/// Reads it; empty without one. Throws files::IoError if it is unreadable, or if the recording is compressed
/// file by file.
Metadata read_metadata(const std::filesystem::path& folder);

}  // namespace sonopose::ros2::bag
