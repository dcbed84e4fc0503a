#pragma once
// The option --compression, common to all programs that write MCAP files.

#include "mcap/compression.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// Adds --compression; `compression` is the default.
CLI::Option* add_compression_option(CLI::App& app, mcap::Compression& compression);

}  // namespace sonopose::apps
