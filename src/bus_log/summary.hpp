#pragma once
/// \file
/// A recording in a few lines.

#include "mcap/reader.hpp"

#include <string>
#include <vector>

namespace sonopose::bus_log {

/// File, times, a table of the topics, metadata, and what is damaged: by the reader, and `more`.
std::string summary_text(const mcap::Reader& reader, const std::vector<std::string>& more = {});

/// The same as one JSON object.
std::string summary_json(const mcap::Reader& reader, const std::vector<std::string>& more = {});

/// Whether neither the reader, nor its metadata, nor `more` has a damage.
bool is_sound(const mcap::Reader& reader, const std::vector<std::string>& more);

}  // namespace sonopose::bus_log
