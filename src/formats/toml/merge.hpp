#pragma once
/// \file
/// Changes single values of a TOML file and keeps everything else, such as comments and line endings.

#include <filesystem>
#include <span>
#include <string>

namespace sonopose::toml {

/// A line `name = value` in a table.
struct Assignment {
  std::string table;    ///< "heading", "beacon.7.heading"
  std::string name;     ///< "mount_offset_deg"
  std::string value;    ///< value as TOML text
  std::string comment;  ///< comment behind the value; empty: none
};

/// Replaces the lines of existing values, and adds the others to their tables or to new ones at the end.
/// Creates a missing file, and replaces an existing one atomically. Throws files::IoError and leaves the file
/// unchanged if it cannot be read or written or is not TOML. The same holds if one of the values is not on a
/// line of its own.
void merge(const std::filesystem::path& file, std::span<const Assignment> assignments);

}  // namespace sonopose::toml
