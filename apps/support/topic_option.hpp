#pragma once
// Options that name a topic.

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// Accepts only native topics. The error names the nearest one and all others.
CLI::Validator topic_name();

}  // namespace sonopose::apps
