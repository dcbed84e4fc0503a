#pragma once
// The topics of recordings of rosbag2, common to all programs that read the inputs of the fusion.

#include "command_line.hpp"

namespace sonopose::apps {

/// Adds --imu-in, --fix-in and so on, which apply to all recordings of the program.
void add_bag_options(CommandLine& app);

}  // namespace sonopose::apps
