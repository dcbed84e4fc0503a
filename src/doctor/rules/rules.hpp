#pragma once
// The doctor's rules, a group per file. Each adds what it finds.

#include "doctor/rules/doctor.hpp"

#include <string>
#include <vector>

namespace sonopose::doctor::doctor {

using Findings = std::vector<Finding>;

/// Network, and who is missing.
void look_at_bus(const Observations& seen, Findings& findings);
/// Readers and writers: types, QoS, parts of the domain.
void look_at_topics(const Observations& seen, Findings& findings);
/// One beacon's streams, fusions, numbering, clock and line.
void look_at_beacon(const Observations& seen, const BeaconSeen& beacon, Findings& findings);
/// What its poses have said of themselves all the time.
void look_at_pose(const BeaconSeen& beacon, Findings& findings);
/// How its IMU is mounted and calibrated, where it rests.
void look_at_mount(const BeaconSeen& beacon, Findings& findings);

/// "beacon 7".
std::string name_of(const BeaconSeen& beacon);

/// The endpoints of one topic.
std::vector<const EndpointSeen*> on_topic(const std::vector<EndpointSeen>& endpoints,
                                          const std::string& topic);

}  // namespace sonopose::doctor::doctor
