#include "doctor/rules/rules.hpp"
#include <sonopose/samples/pose.hpp>

#include <array>

namespace sonopose::doctor::doctor {
namespace {

/// A status bit that lasts means something only where it should have gone.
struct Lasting {
  PoseStatus bit;
  const char* what;
  const char* remedy;
};

constexpr std::array lasting_bits{
    Lasting{status_initialising, "its fusion is still starting",
            "hold the beacon still for some seconds, and see that fixes come"},
    Lasting{status_uncalibrated, "its gyroscope has never been seen at rest",
            "let it stand still for a second; where it never can, measure the offset: sonopose-calibrate "
            "gyroscope "
            "(docs/calibration.md)"},
    Lasting{status_stale, "its fusion has had no valid fix for longer than outage.stale_after_s allows",
            "see that fixes come and are not all refused: sonopose-monitor tells how many are used"},
    Lasting{status_heading_unknown, "its heading is not known",
            "with a pair, see that headings come; a single beacon must be moved first"},
    Lasting{
        status_frozen_track, "its fixes repeat one spot while the IMU says that it moves",
        "look at the positioning system's dashboard: the beacon is frozen there too; where it really stands, "
        "raise frozen.moved_m"},
    Lasting{status_imu_gap, "its IMU keeps falling silent", "look at the line to the beacon"},
    Lasting{status_low_trust, "its fusion doubts the fixes",
            "look for reflections and a wrong map; docs/tuning.md, trust.sigma_m"},
};

}  // namespace

void check_pose(const BeaconObservation& beacon, Findings& findings) {
  if (beacon.pose.samples == 0) return;
  for (const Lasting& lasting : lasting_bits) {
    if ((beacon.lasting_status & lasting.bit) == 0U) continue;
    // Before it has started the rest is no news, and without a pair a heading is learned by moving.
    const bool waits_for_motion = lasting.bit == status_heading_unknown && beacon.heading.samples == 0;
    findings.push_back({waits_for_motion ? Severity::note : Severity::warning, name_of(beacon), lasting.what,
                        lasting.remedy});
    if (lasting.bit == status_initialising) return;
  }
}

}  // namespace sonopose::doctor::doctor
