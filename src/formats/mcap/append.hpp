#pragma once
/// \file
/// Joins the contents of several files to those of one recording.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

#include <cstdint>
#include <map>

namespace sonopose::mcap {

/// Appends the contents of the next file. Channels and schemas that the recording has are not repeated.
/// Returns the new id of each channel. Throws FormatError if there are too many.
std::map<std::uint16_t, std::uint16_t> append(Contents& recording, Contents next, const RecordFile& file,
                                              std::size_t number);

}  // namespace sonopose::mcap
