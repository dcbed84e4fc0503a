#pragma once
// Warnings of faults of the installation, common to the programs that run recordings.

#include "installation/recorded.hpp"

#include <span>
#include <string>

namespace sonopose::apps {

/// Logs each fault that the events show. Returns true if there is an error among them.
bool warn_of_installation(const std::string& name, std::span<const Event> events,
                          const settings::Settings& settings, installation::Search search);

}  // namespace sonopose::apps
