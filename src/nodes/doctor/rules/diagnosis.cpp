#include "doctor/rules/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

namespace sonopose::doctor::rules {

std::string name_of(const BeaconObservation& beacon) {
  return fmt::format("beacon {}", beacon.address);
}

std::vector<const EndpointObservation*> on_topic(const std::vector<EndpointObservation>& endpoints,
                                                 const std::string& topic) {
  std::vector<const EndpointObservation*> found;
  for (const EndpointObservation& endpoint : endpoints) {
    if (endpoint.topic == topic) found.push_back(&endpoint);
  }
  return found;
}

installation::Evidence evidence_of(const BeaconObservation& beacon) {
  return {.settings = beacon.fusion_settings,
          .pieces = beacon.pieces,
          .imu_summary = beacon.imu_summary,
          .turn_gain = beacon.turn_gain,
          .are_headings_of_body =
              beacon.valid_pair_headings == 0 && beacon.heading.samples > beacon.pair_headings,
          .are_fixes_timed = 2 * beacon.timed_fixes > beacon.fix.samples,
          .min_fix_delay_s = beacon.min_fix_delay_s};
}

void add_faults(const BeaconObservation& beacon, std::vector<installation::Finding> faults,
                Findings& findings) {
  for (installation::Finding& fault : faults) {
    findings.push_back({fault.is_error ? Severity::error : Severity::warning, name_of(beacon),
                        std::move(fault.text), std::move(fault.remedy)});
  }
}

void check_installation(const BeaconObservation& beacon, Findings& findings) {
  add_faults(beacon, installation::findings_of(evidence_of(beacon)), findings);
}

namespace {

constexpr double max_frozen_share = 0.1;  ///< share of the time; with more, the installation is not judged

/// Leaves out repetitions: a standby has two writers of poses, each of which may be wrong.
Findings without_repetitions(const Findings& findings) {
  std::set<std::pair<std::string, std::string>> known;
  Findings different;
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(different),
               [&](const Finding& finding) { return known.emplace(finding.subject, finding.what).second; });
  return different;
}

}  // namespace

std::vector<Finding> diagnose(const Observations& observations) {
  Findings findings;
  check_bus(observations, findings);
  check_topics(observations, findings);
  check_lines(observations, findings);
  check_pose_writers(observations, findings);
  for (const BeaconObservation& beacon : observations.beacons) {
    const bool is_imu_right = check_imu(beacon, findings);  // the causes first
    check_beacon(observations, beacon, is_imu_right, findings);
    const std::size_t before = findings.size();
    const auto cause = [&] {
      if (!is_imu_right) return Cause::imu;  // what is fitted with its readings is wrong too
      if (beacon.bridges.size() > 1) return Cause::installation;  // two bridges mix their samples
      if (!check_fixes(beacon, findings)) return Cause::installation;
      // Repeated positions do not fit any installation, and all of them are outliers.
      const bool is_frozen = beacon.status_counts.share_of(status_frozen_track) > max_frozen_share;
      if (!is_frozen) check_installation(beacon, findings);
      if (findings.size() > before) return Cause::installation;
      // A wrong mount, delay or sign makes right fixes look wrong, and the fusion doubts them.
      check_tracks(beacon, is_frozen, findings);
      return findings.size() > before ? Cause::fixes : Cause::none;
    }();
    check_pose(observations.window_s, beacon, cause, findings);
  }
  return without_repetitions(findings);
}

bool has_problems(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.severity >= Severity::warning; });
}

}  // namespace sonopose::doctor::rules
