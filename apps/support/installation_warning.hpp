#pragma once
// Warnings of faults of the installation, common to the programs that run recordings.

#include "installation/recorded.hpp"

#include <set>
#include <span>
#include <string>

namespace sonopose::apps {

/// Warnings about one recording, each of which is logged once, however many runs give it.
class Warnings {
public:
  void add(const std::string& text);

private:
  std::set<std::string> logged_;
};

/// Logs each fault that the events show. Returns true if there is an error among them.
bool warn_of_installation(const std::string& name, std::span<const Event> events,
                          const settings::Settings& settings, installation::Search search,
                          Warnings& warnings);

}  // namespace sonopose::apps
