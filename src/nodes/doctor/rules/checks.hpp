#pragma once
// The checks of the doctor, one file per group. Each appends its findings.

#include "doctor/rules/diagnosis.hpp"
#include "installation/installation.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::doctor::rules {

using Findings = std::vector<Finding>;

/// Checks the network, and reports missing processes.
void check_bus(const Observations& observations, Findings& findings);
/// Checks readers and writers: types, QoS, partitions.
void check_topics(const Observations& observations, Findings& findings);
/// True if no fusion can receive from any bridge, because of types or QoS. A fusion is a process that reads
/// IMU samples and writes poses.
bool no_fusion_receives_imu(const Observations& observations);
/// Checks the lines of the bridges.
void check_lines(const Observations& observations, Findings& findings);
/// Reports processes that should not write poses, or that write them with equal strength.
void check_pose_writers(const Observations& observations, Findings& findings);
/// Checks one beacon's streams, fusions, numbering, clock and line. Without a right IMU, it does not report
/// that the fusion has no use for the samples.
void check_beacon(const Observations& observations, const BeaconObservation& beacon, bool is_imu_right,
                  Findings& findings);
/// A reported problem that explains others; later values are stronger. Wrong fixes explain doubts about
/// fixes. Wrong values of all fixes, a wrong installation, or two bridges make right fixes seem wrong too, up
/// to their rejection.
/// Wrong units or axes of the IMU can keep its fusion from starting.
enum class Cause : std::uint8_t { none, fixes, installation, imu };
/// Reports lasting status bits of one beacon's poses, except those that `cause` explains.
void check_pose(double window_s, const BeaconObservation& beacon, Cause cause, Findings& findings);
/// Properties of one beacon's samples that show faults of its installation.
installation::Evidence evidence_of(const BeaconObservation& beacon);
/// Adds faults of one beacon's installation.
void add_faults(const BeaconObservation& beacon, std::vector<installation::Finding> faults,
                Findings& findings);
/// Checks clocks, map, signs, mount offset and delay of one beacon, if it moves.
void check_installation(const BeaconObservation& beacon, Findings& findings);
/// Reports fixes and headings in wrong units, default positions and positions that are sent again. Returns
/// false if whatever is fitted to them is wrong too; default positions are left out of the fit.
bool check_fixes(const BeaconObservation& beacon, Findings& findings);
/// Reports fixes off the track of one beacon.
void check_tracks(const BeaconObservation& beacon, bool is_frozen, Findings& findings);
/// Checks units, mount and calibration of one beacon's IMU. Returns false if units or axes are wrong: then
/// whatever is computed from its readings is wrong too.
bool check_imu(const BeaconObservation& beacon, Findings& findings);

/// "beacon 7".
std::string name_of(const BeaconObservation& beacon);

}  // namespace sonopose::doctor::rules
