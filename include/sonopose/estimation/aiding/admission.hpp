#pragma once
/// \file
/// Input validation: events must be finite, possible, in order and (item 12) of sufficient quality.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>

namespace sonopose::estimation::aiding {

using settings::AdmissionSettings;

struct AdmissionState {
  int backward_in_row = 0;          ///< consecutive IMU samples that precede the state's time
  TimeNs last_fix_measured_ns = 0;  ///< measurement time of the latest admitted fix; 0 before the first
  TimeNs announced_ns = 0;          ///< stamp of an unconfirmed sample that is far ahead; 0: none
  int ahead_in_row = 0;             ///< consecutive unconfirmed samples

  bool operator==(const AdmissionState&) const = default;
};

namespace admission {

/// Largest lead of a measurement over the latest IMU sample. A sample may arrive after it.
inline constexpr double future_tolerance_s = 0.3;

/// True if a stamp is in the valid range, in which differences do not overflow.
[[nodiscard]] bool is_time(TimeNs stamp_ns);

/// True if an IMU sample is a possible measurement that follows the state at `now_ns` (0: no state yet).
/// Equal stamps are admitted: a clock with a resolution of a millisecond assigns them to distinct samples.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const ImuSample& imu);

/// True if an admissible sample is so far ahead of the state's time that later ones must confirm it
/// (is_unconfirmed_jump).
[[nodiscard]] bool is_time_jump(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// Registers a sample that was not admitted. Returns true after several consecutive samples before the
/// state's time. The state's time must then be wrong: the host's clock was set back, or one stamp was far in
/// the future.
[[nodiscard]] bool needs_time_reset(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// True if a heading measured at `measured_ns` is a possible and recent measurement.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const PairHeading& heading,
                          TimeNs measured_ns, double ahead_s = future_tolerance_s);

/// True if the values of a velocity are finite and below 1000 m/s.
[[nodiscard]] bool is_possible(const TwistSample& twist);

/// True if a velocity is a possible and recent measurement.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const TwistSample& twist,
                          TimeNs measured_ns, double ahead_s = future_tolerance_s);

/// Bits of FixFlag that exclude a fix measured at `measured_ns`, in whatever order fixes arrive; 0: none.
[[nodiscard]] std::uint32_t fix_rejection_flags(const AdmissionSettings& settings, TimeNs now_ns,
                                                const UltrasonicFix& fix, TimeNs measured_ns,
                                                double ahead_s = future_tolerance_s);

/// Position of a fix. Coordinates that the user leaves unknown in a pose (standard deviations of 50 m and
/// more) are those of `estimated_world_m`, the estimate of the same point.
[[nodiscard]] Vector3d completed_position(const UltrasonicFix& fix, const Vector3d& estimated_world_m);

/// Like `fix_rejection_flags`, for fixes in the order of their measurement. Records an admitted one.
[[nodiscard]] std::uint32_t rejection_flags(const AdmissionSettings& settings, AdmissionState& state,
                                            TimeNs now_ns, const UltrasonicFix& fix, TimeNs measured_ns);

}  // namespace admission
}  // namespace sonopose::estimation::aiding
