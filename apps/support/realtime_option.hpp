#pragma once
// The option --realtime, common to all programs between a sample and its pose.

#include "command_line.hpp"
#include "process/realtime.hpp"

namespace sonopose::apps {

/// The group of this option.
inline constexpr const char* realtime_group = "Real time";

/// Adds --realtime[=PRIORITY]; `priority` stays 0 without it.
void add_realtime_option(CommandLine& app, int& priority);

/// Applies the option if it was given, and logs what was applied or refused. Call it after the node is
/// created, and keep the result until the end.
[[nodiscard]] process::Realtime realtime(int priority);

}  // namespace sonopose::apps
