#pragma once
// Options that name a topic.

#include "command_line.hpp"

namespace sonopose::apps {

/// Accepts only native topics. The error names the nearest one and all others.
Check topic_name();

}  // namespace sonopose::apps
