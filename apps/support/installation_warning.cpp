#include "installation_warning.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

namespace sonopose::apps {

bool warn_of_installation(const std::string& name, const std::vector<Event>& events,
                          const settings::Settings& settings, installation::Search search) {
  const auto findings = installation::findings_in(events, settings, search);
  for (const installation::Finding& each : findings) {
    logging::warning(fmt::format("{}: {}: {}", name, each.text, each.remedy));
  }
  return !findings.empty();
}

}  // namespace sonopose::apps
