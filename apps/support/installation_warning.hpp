#pragma once
// Warnings of faults of the installation, common to the programs that run recordings.

#include "installation/recorded.hpp"

#include <string>
#include <vector>

namespace sonopose::apps {

/// Logs each fault that the events show. Returns false if there is none.
bool warn_of_installation(const std::string& name, const std::vector<Event>& events,
                          const settings::Settings& settings, installation::Search search);

}  // namespace sonopose::apps
