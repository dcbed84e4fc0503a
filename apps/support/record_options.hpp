#pragma once
// The options of sonopose-record that limit its files and its memory.

#include "command_line.hpp"
#include "recorder/recorder_node.hpp"

namespace sonopose::apps {

/// Adds --compression and the limits of the files.
void add_file_options(CommandLine& app, recorder::RecorderOptions& options);

/// Adds --keep-last and its options. Needs --ros2.
void add_last_options(CommandLine& app, recorder::RecorderOptions& options);

}  // namespace sonopose::apps
