#pragma once
// The option --log-level, common to all programs that serve.

#include "logging/log.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// The group of this option.
inline constexpr const char* log_group = "Log";

/// Adds --log-level; `level` is the default.
CLI::Option* add_log_option(CLI::App& app, logging::Level& level);

}  // namespace sonopose::apps
