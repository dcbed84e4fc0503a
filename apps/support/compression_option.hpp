#pragma once
// What the programs that write MCAP files have in common: --compression.

#include "mcap/compression.hpp"

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// Adds --compression; `compression` stays as it is without it.
CLI::Option* add_compression_option(CLI::App& app, mcap::Compression& compression);

}  // namespace sonopose::apps
