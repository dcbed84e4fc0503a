#pragma once
// What the programs on the way of a pose have in common: --realtime.

#include "process/realtime.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// Adds --realtime[=PRIORITY]; `priority` stays 0 without it.
void add_realtime_option(CLI::App& app, int& priority);

/// Applies it where it was asked for and says on standard error what holds and what does not. To be called
/// when the node was made; what it gives is to be kept until the end.
[[nodiscard]] process::Realtime realtime(const CLI::App& app, int priority);

}  // namespace sonopose::apps
