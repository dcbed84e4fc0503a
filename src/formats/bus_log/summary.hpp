#pragma once
/// \file
/// Summarizes a recording in a few lines.

#include "mcap/reader.hpp"

#include <string>
#include <vector>

namespace sonopose::bus_log {

/// Lists file, times, topics, metadata and damage. `more` adds damage that the reader does not know.
std::string summary_text(const mcap::Reader& reader, const std::vector<std::string>& more = {});

/// Formats the summary as one JSON object.
std::string summary_json(const mcap::Reader& reader, const std::vector<std::string>& more = {});

/// Returns true if the reader, its metadata and `more` have no damage.
bool is_sound(const mcap::Reader& reader, const std::vector<std::string>& more);

}  // namespace sonopose::bus_log
