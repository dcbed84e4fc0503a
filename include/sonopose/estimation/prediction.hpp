#pragma once
/// \file
/// Poses between IMU samples.

#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation {

/// The period of predicted poses (setting output.rate_hz); 0 if none are requested.
[[nodiscard]] TimeNs prediction_period_ns(const settings::OutputSettings& settings);

/// The pose of an IMU sample, extrapolated by `ahead_ns` ≥ 0 at constant turn rate and acceleration and
/// marked as predicted. A pose whose status says that acceleration is ignored (stale, initialising, rotating
/// fast) is extrapolated at constant velocity.
[[nodiscard]] FusedPose predicted(const FusedPose& at_sample, TimeNs ahead_ns);

}  // namespace sonopose::estimation
