#pragma once
/// \file
/// Poses between IMU samples: what a pose becomes a short time later, and how often that is asked for.

#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::OutputSettings;

namespace output {

/// The time from one predicted pose to the next; 0 where none are asked for.
[[nodiscard]] TimeNs period_ns(const OutputSettings& settings);

/// The pose of an IMU sample moved on by `ahead_ns` ≥ 0 at its turn rate and acceleration, and marked as
/// predicted. A pose that ignores acceleration (stale, initialising, rotating fast) goes on at its velocity.
[[nodiscard]] FusedPose predicted(const FusedPose& at_sample, TimeNs ahead_ns);

}  // namespace output
}  // namespace sonopose::estimation::documented
