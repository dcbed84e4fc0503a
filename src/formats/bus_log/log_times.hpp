#pragma once
/// \file
/// Finds steps and gaps of the log times of a recording.

#include "mcap/reader.hpp"

#include <optional>
#include <string>

namespace sonopose::bus_log {

/// Describes where the log times of a file go back, since the host's clock was set; empty if they do not.
std::optional<std::string> step_back_in(const mcap::Reader& reader);

/// Describes the longest time without a message, of at least 5 s, such as of a file that is missing, or of a
/// clock that was set ahead; empty if there is none.
std::optional<std::string> longest_gap_in(const mcap::Reader& reader);

/// Logs both.
void warn_of_times(const mcap::Reader& reader);

}  // namespace sonopose::bus_log
