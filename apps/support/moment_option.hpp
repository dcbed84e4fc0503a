#pragma once
// The options --start and --end of a part of a recording.

#include "bus_log/moment.hpp"
#include "command_line.hpp"

#include <optional>

namespace sonopose::apps {

/// Adds --start and --end: seconds after the first message, a UTC time, or a log time in ns.
void add_span_options(CommandLine& app, std::optional<bus_log::Moment>& start,
                      std::optional<bus_log::Moment>& end);

}  // namespace sonopose::apps
