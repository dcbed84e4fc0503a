#pragma once
/// \file
/// Whether a file is sound, also where a reader with an index does not look.

#include "mcap/reader.hpp"

#include <string>
#include <vector>

namespace sonopose::mcap {

/// Reads all of the data section: its records, the chunks and their number of messages, and the checksums of
/// chunks, of attachments and of the whole. Describes each damage that the reader has not reported; a
/// checksum of 0 means that there is none. Throws files::IoError.
std::vector<std::string> verify(const Reader& reader);

}  // namespace sonopose::mcap
