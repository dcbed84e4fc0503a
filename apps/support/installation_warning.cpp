#include "installation_warning.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::apps {

void Warnings::add(const std::string& text) {
  if (logged_.insert(text).second) logging::warning(text);
}

bool warn_of_installation(const std::string& name, std::span<const Event> events,
                          const settings::Settings& settings, installation::Search search,
                          Warnings& warnings) {
  const auto findings = installation::findings_in(events, settings, search);
  for (const installation::Finding& each : findings) {
    warnings.add(fmt::format("{}: {}: {}", name, each.text, each.remedy));
  }
  return std::ranges::any_of(findings, &installation::Finding::is_error);
}

}  // namespace sonopose::apps
