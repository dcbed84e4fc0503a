#pragma once
// The checks of the doctor, one file per group. Each appends its findings.

#include "doctor/rules/diagnosis.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::doctor::rules {

using Findings = std::vector<Finding>;

/// The network, and missing processes.
void check_bus(const Observations& observations, Findings& findings);
/// Readers and writers: types, QoS, partitions.
void check_topics(const Observations& observations, Findings& findings);
/// Whether no fusion (a process that reads IMU samples and writes poses) can receive from any bridge, by type
/// or QoS.
bool no_fusion_receives_imu(const Observations& observations);
/// The lines of the bridges.
void check_lines(const Observations& observations, Findings& findings);
/// Processes that write poses and should not, or with the same strength.
void check_pose_writers(const Observations& observations, Findings& findings);
/// One beacon's streams, fusions, numbering, clock and line.
void check_beacon(const Observations& observations, const BeaconObservation& beacon, Findings& findings);
/// What is reported already and explains other problems, the stronger the later: wrong fixes explain doubts
/// about them; a wrong installation (or two bridges) also makes right fixes look wrong, up to their
/// rejection.
enum class Cause : std::uint8_t { none, fixes, installation };
/// The status bits that the poses of one beacon have for long, except those that `cause` explains.
void check_pose(double window_s, const BeaconObservation& beacon, Cause cause, Findings& findings);
/// Mount offset, delay and signs of the accelerometer of one beacon, if it moves.
void check_installation(const BeaconObservation& beacon, Findings& findings);
/// Fixes off the track of one beacon.
void check_tracks(const BeaconObservation& beacon, Findings& findings);
/// Mount and calibration of one beacon's IMU, if it is at rest.
void check_mount(const BeaconObservation& beacon, Findings& findings);

/// "beacon 7".
std::string name_of(const BeaconObservation& beacon);

}  // namespace sonopose::doctor::rules
