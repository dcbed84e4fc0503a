#pragma once
/// \file
/// Poses between IMU samples.

#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation {

/// Period of predicted poses (setting output.rate_hz); 0 if none are requested.
[[nodiscard]] TimeNs prediction_period_ns(const settings::OutputSettings& settings);

/// Extrapolates the pose of an IMU sample by `ahead_ns` ≥ 0 at constant turn rate and acceleration, and marks
/// it as predicted. If its status says that acceleration is ignored (stale, initialising, rotating fast),
/// velocity stays constant.
[[nodiscard]] FusedPose predicted(const FusedPose& at_sample, TimeNs ahead_ns);

}  // namespace sonopose::estimation
