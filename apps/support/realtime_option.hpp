#pragma once
// What the programs between a sample and its pose have in common: --realtime.

#include "process/realtime.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// The group of this option.
inline constexpr const char* realtime_group = "Real time";

/// Adds --realtime[=PRIORITY]; `priority` stays 0 without it.
void add_realtime_option(CLI::App& app, int& priority);

/// Applies it where it was asked for, and logs what was applied and what was refused.
/// Call it after the node is made, and keep the result until the end.
[[nodiscard]] process::Realtime realtime(int priority);

}  // namespace sonopose::apps
