#pragma once
/// \file
/// The files of a recording.

#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::bus_log {

/// Returns the MCAP files in a folder, by name: run_9 before run_10 (strverscmp). Empty
/// for a log folder, and for anything else but a folder.
std::vector<std::filesystem::path> mcap_files_in(const std::filesystem::path& folder);

/// Returns the given files, and those of the given folders, which are one recording. Warns of files that a
/// folder of rosbag2 should have. Throws files::IoError if a folder has no MCAP or SQLite file.
std::vector<std::filesystem::path> recording_files(const std::vector<std::filesystem::path>& given);

/// Returns true for several paths, for a file that begins like MCAP, and for a folder of such files.
bool is_in_mcap(const std::vector<std::filesystem::path>& recording);

/// Returns true for a SQLite file of rosbag2, and for a folder of them.
bool is_in_sqlite(const std::vector<std::filesystem::path>& recording);

/// Returns false for a file, and for a folder with the files of one recording in MCAP or SQLite.
bool is_log_folder(const std::filesystem::path& recording);

/// Name of a recording, for messages: the path, or the first one and the number of the others.
std::string name_of(const std::vector<std::filesystem::path>& recording);

}  // namespace sonopose::bus_log
