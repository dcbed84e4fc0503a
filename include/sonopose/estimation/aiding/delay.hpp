#pragma once
/// \file
/// Item 6: the time at which a fix or heading was measured.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::aiding {

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
