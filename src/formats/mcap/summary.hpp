#pragma once
/// \file
/// Reads the contents of a file from its summary section.

#include "mcap/contents.hpp"
#include "mcap/record_file.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::mcap {

/// Result of reading a summary.
struct SummaryReading {
  std::optional<Contents> contents;            ///< empty if the summary does not suffice to find all messages
  std::string damage;                          ///< damage of the summary or between the chunks
  std::optional<std::uint64_t> message_count;  ///< number of messages that the summary states
  std::vector<std::uint64_t> record_offsets{};  ///< known starts of records, ascending
};

/// Reads the summary and the indexes of messages. Throws FormatError if this is not an MCAP file.
SummaryReading read_summary(const RecordFile& file);

}  // namespace sonopose::mcap
