#pragma once
/// \file
/// Reads the contents of a file from its summary section.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

#include <optional>

namespace sonopose::mcap {

/// Returns empty if the file has no summary, or one that does not suffice to find its messages. Throws
/// FormatError if the summary or the end of the file is damaged.
std::optional<Contents> read_summary(const RecordFile& file);

}  // namespace sonopose::mcap
