#pragma once
/// \file
/// The files of a recording.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::bus_log {

/// Returns the MCAP files in a folder, by name: run_9 before run_10 (strverscmp). Empty
/// for a log folder, and for anything else but a folder.
std::vector<std::filesystem::path> mcap_files_in(const std::filesystem::path& folder);

/// Returns the given files, and those of the given folders, which are one recording: of rosbag2's, those that
/// its metadata.yaml lists. Warns of those that are missing or not read. Throws files::IoError if a folder
/// has no MCAP or SQLite file.
std::vector<std::filesystem::path> recording_files(const std::vector<std::filesystem::path>& given);

/// Returns a sentence if the folders of a recording should have more than this number of messages.
std::optional<std::string> fewer_than_listed(const std::vector<std::filesystem::path>& recording,
                                             std::uint64_t messages);

/// Returns true for several paths, for a file that begins like MCAP, and for a folder of such files.
bool is_in_mcap(const std::vector<std::filesystem::path>& recording);

/// Returns true for a SQLite file of rosbag2, and for a folder of them.
bool is_in_sqlite(const std::vector<std::filesystem::path>& recording);

/// Returns false for a file, and for a folder with the files of one recording in MCAP or SQLite.
bool is_log_folder(const std::filesystem::path& recording);

/// Name of a recording, for messages: the path, or the first one and the number of the others.
std::string name_of(const std::vector<std::filesystem::path>& recording);

}  // namespace sonopose::bus_log
