#pragma once
/// \file
/// Checks whether a file is sound, including parts that a reader with an index skips.

#include "mcap/reader.hpp"

#include <string>
#include <vector>

namespace sonopose::mcap {

/// Reads the complete data section: its records, the chunks and their number of messages, and the checksums
/// of chunks, attachments and the whole. Describes damage that the reader has not reported. A checksum of 0
/// means that there is none. Throws files::IoError.
std::vector<std::string> verify(const Reader& reader);

}  // namespace sonopose::mcap
