#pragma once
// What the programs that serve have in common: --log-level.

#include "logging/log.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// The group of this option.
inline constexpr const char* log_group = "Log";

/// Adds --log-level; `level` stays as it is without it.
CLI::Option* add_log_option(CLI::App& app, logging::Level& level);

}  // namespace sonopose::apps
