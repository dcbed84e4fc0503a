#pragma once
// The doctor's rules, a group per file. Each adds what it finds.

#include "doctor/rules/doctor.hpp"

#include <string>
#include <vector>

namespace sonopose::doctor::doctor {

using Findings = std::vector<Finding>;

/// Network, and who is missing.
void check_bus(const Observations& seen, Findings& findings);
/// Readers and writers: types, QoS, parts of the domain.
void check_topics(const Observations& seen, Findings& findings);
/// One beacon's streams, fusions, numbering, clock and line.
void check_beacon(const Observations& seen, const BeaconObservation& beacon, Findings& findings);
/// What its poses have said of themselves all the time.
void check_pose(const BeaconObservation& beacon, Findings& findings);
/// How its IMU is mounted and calibrated, where it rests.
void check_mount(const BeaconObservation& beacon, Findings& findings);

/// "beacon 7".
std::string name_of(const BeaconObservation& beacon);

/// The endpoints of one topic.
std::vector<const EndpointObservation*> on_topic(const std::vector<EndpointObservation>& endpoints,
                                          const std::string& topic);

}  // namespace sonopose::doctor::doctor
