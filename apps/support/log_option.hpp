#pragma once
// The option --log-level, common to all programs that serve.

#include "command_line.hpp"
#include "logging/log.hpp"

namespace sonopose::apps {

/// The group of this option.
inline constexpr const char* log_group = "Log";

/// Adds --log-level; `level` is the default.
Option add_log_option(CommandLine& app, logging::Level& level);

}  // namespace sonopose::apps
