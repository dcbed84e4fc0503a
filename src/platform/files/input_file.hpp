#pragma once
/// \file
/// Opens and reads files that a user has given.

#include "files/descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace sonopose::files {

/// Opens a file for reading. Never waits. Throws IoError for a folder, a named pipe, a socket or a device,
/// which is not even opened; a pipe of the shell (`<(command)`) and /dev/null can be read like a file.
Descriptor open_input(const std::filesystem::path& file);

/// Limit of a file that is read as a whole, in bytes.
inline constexpr std::uintmax_t max_text_bytes = 64U << 20U;

/// Reads a whole file. Throws IoError if it cannot be opened or read, or is larger than the limit.
std::string read_text(const std::filesystem::path& file);

}  // namespace sonopose::files
