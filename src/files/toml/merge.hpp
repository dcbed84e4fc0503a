#pragma once
/// \file
/// Changes single values of a TOML file and keeps everything else: comments, and how its lines end.

#include <filesystem>
#include <span>
#include <string>

namespace sonopose::files::toml {

/// A line `name = value` in a table.
struct Assignment {
  std::string table;    ///< "heading", "beacon.7.heading"
  std::string name;     ///< "mount_offset_deg"
  std::string value;    ///< as TOML has it
  std::string comment;  ///< behind the value; empty: none
};

/// Replaces the lines of values that the file has, and adds the others to their tables or to new ones at the
/// end. A file that does not exist is created. The file is replaced atomically. Throws IoError if it cannot
/// be read or written, is not TOML, or has one of the values in another form than a line of its own; it is
/// then unchanged.
void merge(const std::filesystem::path& file, std::span<const Assignment> assignments);

}  // namespace sonopose::files::toml
