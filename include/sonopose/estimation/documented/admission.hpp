#pragma once
/// \file
/// What may enter the engine: finite, possible, in order, and (item 12) of sufficient quality.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>

namespace sonopose::estimation::documented {

using settings::AdmissionSettings;

struct AdmissionState {
  int backward_in_row = 0;          ///< IMU samples from before the state's time, one after the other
  TimeNs last_fix_measured_ns = 0;  ///< of the latest admitted fix; 0 before the first
  TimeNs announced_ns = 0;          ///< stamp of a sample that was too far ahead to be believed alone; or 0

  bool operator==(const AdmissionState&) const = default;
};

namespace admission {

/// Whether a stamp can be a time at all: differences of such stamps do not overflow.
[[nodiscard]] bool is_time(TimeNs stamp_ns);

/// Whether an IMU sample can be a measurement that follows the state at `now_ns` (0: none yet). Equal stamps
/// may: a clock of whole milliseconds gives them to samples that were measured apart.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const ImuSample& imu);

/// Whether an admissible sample lies so far ahead of the state's time that it is not believed before the next
/// one confirms it: one broken stamp must not cost all that follows.
[[nodiscard]] bool is_sudden(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// Takes note of a sample that was not admitted. True when so many in a row came from before the state's time
/// that it is the time that was wrong: the host's clock has been set back, or one stamp lay far in the
/// future.
[[nodiscard]] bool time_was_wrong(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// Whether a heading that was measured at `measured_ns` can be a measurement of this time.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const PairHeading& heading,
                          TimeNs measured_ns);

/// The bits of FixFlag that keep a fix out that was measured at `measured_ns` (0: it is admitted, and
/// remembered).
[[nodiscard]] std::uint32_t reasons_against(const AdmissionSettings& settings, AdmissionState& state,
                                            TimeNs now_ns, const UltrasonicFix& fix, TimeNs measured_ns);

}  // namespace admission
}  // namespace sonopose::estimation::documented
