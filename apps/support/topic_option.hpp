#pragma once
// Options that name a topic.

#include <CLI/CLI.hpp>

namespace sonopose::apps {

/// Refuses what is no native topic, with the nearest one and all of them.
CLI::Validator topic_name();

}  // namespace sonopose::apps
