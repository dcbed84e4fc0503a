#pragma once
/// \file
/// Finds the contents of a file by reading it from start to end.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

#include <cstdint>
#include <vector>

namespace sonopose::mcap {

/// Reads the header after the leading magic. Throws FormatError if this is not an MCAP file.
Header read_header(const RecordFile& file);

/// Reads every record. Damaged parts are left out and named in `damages`; the file may end anywhere. Where
/// damage hides the start of the next record, reading continues at the next of `known_offsets`, which are
/// ascending. Throws FormatError without a header.
Contents scan(const RecordFile& file, std::vector<std::uint64_t> known_offsets = {});

}  // namespace sonopose::mcap
