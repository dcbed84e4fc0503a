#pragma once
/// \file
/// The checksums that cover what a reader with an index does not read.

#include "mcap/record_file.hpp"

#include <string>
#include <vector>

namespace sonopose::mcap {

/// Reads all of the data section: the checksum of DataEnd, and those of attachments. What does not match, in
/// words; a checksum of 0 means that there is none. Of a file that was cut it checks what is there. Throws
/// files::IoError.
std::vector<std::string> verify(const RecordFile& file);

}  // namespace sonopose::mcap
