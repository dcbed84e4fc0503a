#pragma once
/// \file
/// Poses between IMU samples: what a pose becomes a short time later, and how often that is asked for.

#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::estimation::documented {

struct OutputSettings {
  int rate_hz{};

  static constexpr std::string_view group = "output";
  static constexpr auto declarations() {
    using G = OutputSettings;
    return settings::rows(settings::count(settings::own_setting, "rate_hz", &G::rate_hz, 0, {0, 1000}, "Hz",
                                        "Further poses on a steady clock, predicted from the latest IMU "
                                        "sample; 0: one at each sample alone."));
  }
  constexpr OutputSettings() { settings::set_defaults(*this); }
};

namespace output {

/// The time from one predicted pose to the next; 0 where none are asked for.
[[nodiscard]] TimeNs period_ns(const OutputSettings& settings);

/// The pose of an IMU sample moved on by `ahead_ns` ≥ 0 at its turn rate and acceleration, and marked as
/// predicted. A pose that ignores acceleration (stale, initialising, rotating fast) goes on at its velocity.
[[nodiscard]] FusedPose predicted(const FusedPose& at_sample, TimeNs ahead_ns);

}  // namespace output
}  // namespace sonopose::estimation::documented
