#pragma once
// The option --compression, common to all programs that write MCAP files.

#include "command_line.hpp"
#include "mcap/compression.hpp"

namespace sonopose::apps {

/// Adds --compression; `compression` is the default.
Option add_compression_option(CommandLine& app, mcap::Compression& compression);

}  // namespace sonopose::apps
