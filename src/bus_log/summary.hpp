#pragma once
/// \file
/// A recording in a few lines.

#include "mcap/reader.hpp"

#include <string>

namespace sonopose::bus_log {

/// File, times, a table of the topics, metadata, and what is damaged.
std::string summary_text(const mcap::Reader& reader);

/// The same as one JSON object.
std::string summary_json(const mcap::Reader& reader);

}  // namespace sonopose::bus_log
