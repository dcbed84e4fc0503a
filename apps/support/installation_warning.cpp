#include "installation_warning.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::apps {

bool warn_of_installation(const std::string& name, std::span<const Event> events,
                          const settings::Settings& settings, installation::Search search) {
  const auto findings = installation::findings_in(events, settings, search);
  for (const installation::Finding& each : findings) {
    logging::warning(fmt::format("{}: {}: {}", name, each.text, each.remedy));
  }
  return std::ranges::any_of(findings, &installation::Finding::is_error);
}

}  // namespace sonopose::apps
