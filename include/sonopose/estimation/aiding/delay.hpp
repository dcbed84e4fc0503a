#pragma once
/// \file
/// Item 6: the time at which a fix or heading was measured.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::aiding {

/// A pose that the user sets holds when it arrives, at `now_ns` of the IMU: its stamps are of another clock,
/// and the IMU's samples may arrive late. Its heading comes just before its fix. Returns other samples, and
/// those before the first IMU sample (`now_ns` is 0), unchanged.
[[nodiscard]] UltrasonicFix at_arrival(const UltrasonicFix& fix, TimeNs now_ns);
[[nodiscard]] PairHeading at_arrival(const PairHeading& heading, TimeNs now_ns);

/// Time of the measurement, by its own delay or the fixed one (delay.source). A pose that the user sets has
/// no delay.
[[nodiscard]] TimeNs measured_at(const settings::DelaySettings& settings, const UltrasonicFix& fix);
[[nodiscard]] TimeNs measured_at(const settings::DelaySettings& settings, const PairHeading& heading);

/// Stamp of a velocity: its delay is that of its own source.
[[nodiscard]] inline TimeNs measured_at(const settings::DelaySettings& /*settings*/,
                                        const TwistSample& twist) {
  return twist.emission_time_ns;
}

}  // namespace sonopose::estimation::aiding
