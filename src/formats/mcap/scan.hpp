#pragma once
/// \file
/// Finds the contents of a file by reading it from start to end.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

namespace sonopose::mcap {

/// Reads the header after the leading magic. Throws FormatError if this is not an MCAP file.
Header read_header(const RecordFile& file);

/// Reads every record. Damaged parts are left out and named in `damages`; the file may end anywhere. Throws
/// FormatError without a header.
Contents scan(const RecordFile& file);

}  // namespace sonopose::mcap
