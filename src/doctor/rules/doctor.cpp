#include "doctor/rules/rules.hpp"
#include "doctor/rules/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::doctor {

namespace doctor {

std::string name_of(const BeaconSeen& beacon) {
  return fmt::format("beacon {}", beacon.address);
}

std::vector<const EndpointSeen*> on_topic(const std::vector<EndpointSeen>& endpoints,
                                          const std::string& topic) {
  std::vector<const EndpointSeen*> found;
  for (const EndpointSeen& endpoint : endpoints) {
    if (endpoint.topic == topic) found.push_back(&endpoint);
  }
  return found;
}

}  // namespace doctor

std::string text_of(const ProcessSeen& process) {
  if (process.name.empty() && process.host.empty() && !process.id) return "an unknown process";
  std::string text = process.name.empty() ? "a process" : process.name;
  if (process.id) text += fmt::format(" (process {}", *process.id);
  if (!process.host.empty()) text += (process.id ? " on " : " (on ") + process.host;
  if (process.id || !process.host.empty()) text += ")";
  return text;
}

std::vector<Finding> diagnose(const Observations& seen) {
  doctor::Findings findings;
  doctor::look_at_bus(seen, findings);
  doctor::look_at_topics(seen, findings);
  for (const BeaconSeen& beacon : seen.beacons) {
    doctor::look_at_beacon(seen, beacon, findings);
    doctor::look_at_pose(beacon, findings);
    doctor::look_at_mount(beacon, findings);
  }
  return findings;
}

bool any_wrong(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.severity >= Severity::warning; });
}

}  // namespace sonopose::doctor
