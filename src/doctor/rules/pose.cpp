#include "doctor/rules/checks.hpp"
#include <sonopose/samples/pose.hpp>

#include <array>

namespace sonopose::doctor::rules {
namespace {

/// A status bit that is a problem if all poses of the window have it.
struct LastingBit {
  PoseStatus bit;
  const char* what;
  const char* remedy;
};

constexpr std::array lasting_bits{
    LastingBit{status_initialising, "its fusion is still initialising",
               "keep the beacon still for some seconds, and check that fixes arrive"},
    LastingBit{
        status_uncalibrated, "its gyro bias is not known yet: the beacon was never at rest",
        "let it stand still for a second; if it never can, measure the bias: sonopose-calibrate gyroscope "
        "(docs/calibration.md)"},
    LastingBit{status_stale, "its fusion has had no valid fix for longer than outage.stale_after_s",
               "check that fixes arrive and are not all rejected: sonopose-monitor shows how many are used"},
    LastingBit{status_heading_unknown, "its heading is unknown",
               "with a pair, check that headings arrive; move a single beacon"},
    LastingBit{
        status_frozen_track, "its fixes repeat one position although the IMU measures motion",
        "check the dashboard of the positioning system: the beacon is frozen there too; if the beacon really "
        "stands still, increase frozen.moved_m"},
    LastingBit{status_imu_gap, "its IMU stream has gaps", "check the line to the beacon"},
    LastingBit{status_low_trust, "its fusion has low trust in the fixes",
               "check for reflections and a wrong map; see docs/tuning.md"},
    LastingBit{status_overloaded, "its fusion is overloaded and skips poses",
               "give the fusion more processor time, or share its beacons between several fusions "
               "(docs/realtime.md)"},
};

}  // namespace

void check_pose(const BeaconObservation& beacon, Findings& findings) {
  if (beacon.pose.samples == 0) return;
  for (const LastingBit& lasting : lasting_bits) {
    if ((beacon.lasting_status & lasting.bit) == 0U) continue;
    // A single beacon estimates its heading from motion.
    const bool waits_for_motion = lasting.bit == status_heading_unknown && beacon.heading.samples == 0;
    findings.push_back({waits_for_motion ? Severity::note : Severity::warning, name_of(beacon), lasting.what,
                        lasting.remedy});
    if (lasting.bit == status_initialising) return;  // implies the others
  }
}

}  // namespace sonopose::doctor::rules
