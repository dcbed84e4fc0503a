#include "doctor/rules/checks.hpp"
#include "observation/status_words.hpp"
#include <sonopose/samples/status_meanings.hpp>

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

namespace sonopose::doctor::rules {
namespace {

/// A status bit that is a problem if it lasts.
struct LastingBit {
  PoseStatus bit;
  double min_s;        ///< total time
  double min_share;    ///< additional condition: share of the window
  Cause explained_by;  ///< this cause or a stronger one; none: no other problem explains it
  std::string_view what;
  const char* remedy;
};

// Bits of the first seconds count if they last for most of the window. The others are momentary in a healthy
// system, so their total time counts, however long the window is.
constexpr double min_window_share = 0.5;
constexpr std::array lasting_bits{
    LastingBit{status_initialising, 0.5, min_window_share, Cause::imu, "its fusion is initialising",
               "keep the beacon still for some seconds, and check that fixes arrive"},
    LastingBit{
        status_uncalibrated, 0.5, min_window_share, Cause::installation,
        "its gyro bias is not known: the beacon was not at rest for long enough",
        "let it stand still for a second; if it never can, measure the bias: sonopose-calibrate gyroscope "
        "(docs/calibration.md)"},
    LastingBit{status_stale, 0.3, 0.0, Cause::installation,
               "its fusion has had no valid fix for longer than outage.stale_after_s",
               "check that fixes arrive and are not all rejected: sonopose-monitor shows how many are used"},
    LastingBit{status_heading_unknown, 0.5, min_window_share, Cause::fixes, "its heading is unknown",
               "with a pair, check that headings arrive; move a single beacon"},
    LastingBit{
        status_frozen_track, 0.3, 0.0, Cause::installation,
        "its fixes repeat one position although the IMU measures motion",
        "check the dashboard of the positioning system: the beacon is frozen there too; if the beacon really "
        "stands still, increase frozen.moved_m"},
    LastingBit{status_imu_gap, 0.3, 0.0, Cause::imu, "its IMU stream has gaps",
               "check the line to the beacon"},
    LastingBit{status_low_trust, 1.0, 0.0, Cause::fixes, "its fusion has low trust in the fixes",
               "check for reflections and a wrong map; see docs/tuning.md"},
    LastingBit{
        status_imu_inconsistent, 0.5, 0.0, Cause::installation, imu_inconsistent_meaning,
        "check units, signs, axes and range of the IMU, how it is mounted, and heading.mount_offset_deg"},
    LastingBit{
        status_fixes_inconsistent, 0.3, 0.0, Cause::installation, fixes_inconsistent_meaning,
        "let the source leave out fixes without a solution; check that enough beacons are in sight, and the "
        "stamps of fixes and IMU (sonopose-monitor shows their delay)"},
    LastingBit{status_overloaded, 0.3, 0.0, Cause::none, "its fusion is overloaded and skips poses",
               "give the fusion more processor time, or share its beacons between several fusions "
               "(docs/realtime.md)"},
    LastingBit{status_late, 0.3, 0.0, Cause::none, "its IMU samples were old on arrival",
               "check the network, the load of the machines, and that their clocks agree (docs/realtime.md)"},
};

/// "0.4", "12".
std::string seconds_text(double duration_s) {
  return fmt::format("{:.{}f}", duration_s, duration_s < 10 ? 1 : 0);
}

}  // namespace

void check_pose(double window_s, const BeaconObservation& beacon, Cause cause, Findings& findings) {
  if (beacon.pose.samples == 0) return;
  for (const LastingBit& lasting : lasting_bits) {
    const double share = beacon.status_counts.share_of(lasting.bit);
    if (share * window_s < lasting.min_s || share < lasting.min_share) continue;
    if (lasting.explained_by != Cause::none && cause >= lasting.explained_by) continue;
    // A single beacon estimates its heading from motion.
    const bool waits_for_motion = lasting.bit == status_heading_unknown && beacon.heading.samples == 0;
    findings.push_back({waits_for_motion ? Severity::note : Severity::warning, name_of(beacon),
                        fmt::format("{}: {} ({} of {:.0f} s)", observation::status_words(lasting.bit),
                                    lasting.what, seconds_text(share * window_s), window_s),
                        lasting.remedy});
    // These imply those that follow.
    if (lasting.bit == status_initialising || lasting.bit == status_overloaded) return;
  }
}

}  // namespace sonopose::doctor::rules
