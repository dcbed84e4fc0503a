#pragma once
/// \file
/// The contents of a file, found from its start to its end.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

namespace sonopose::mcap {

/// The header after the magic at the start. Throws FormatError if this is not such a file.
Header read_header(const RecordFile& file);

/// Reads every record. What is damaged is left out and named in `damages`; the file may end anywhere. Throws
/// FormatError without a header.
Contents scan(const RecordFile& file);

}  // namespace sonopose::mcap
