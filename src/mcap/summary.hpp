#pragma once
/// \file
/// The contents of a file, as its summary section says.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

#include <optional>

namespace sonopose::mcap {

/// Empty if the file has no summary, or one without what is needed to find its messages. Throws FormatError
/// if the summary or the end of the file is damaged.
std::optional<Contents> read_summary(const RecordFile& file);

}  // namespace sonopose::mcap
