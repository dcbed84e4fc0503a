#pragma once
/// \file
/// The measurements of one beacon over a window, for the fit of its motion.

#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace sonopose::motion {

/// One IMU sample, with the calibration of the fusion applied.
struct Reading {
  TimeNs time_ns = 0;
  Vector3d rate_body_radps = Vector3d::Zero();
  Vector3d force_body_mps2 = Vector3d::Zero();
};

/// Returns the reading of a sample; empty if it is not finite.
inline std::optional<Reading> reading_of(const ImuSample& imu) {
  if (!imu.angular_velocity_body_radps.allFinite() || !imu.specific_force_body_mps2.allFinite()) return {};
  return Reading{imu.sensor_time_ns, imu.angular_velocity_body_radps, imu.specific_force_body_mps2};
}

/// One fix, with the time at which the fusion takes it for measured.
struct Position {
  TimeNs time_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();
};

/// One valid heading of the pair, before the mount offset.
struct Direction {
  TimeNs time_ns = 0;
  double heading_world_rad = 0;
};

struct Window {
  std::vector<Reading> imu;
  std::vector<Position> fixes;
  std::vector<Direction> headings;
  double mount_rad = 0;         ///< configured angle from body X to the axis of the pair
  double heading_zero_rad = 0;  ///< heading here that the source gives as 0: not 0 for one of the body
};

/// Sorts each stream, and leaves out repeated stamps.
inline void sort_by_time(Window& window) {
  const auto sort = [](auto& all) {
    const auto is_before = [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; };
    const auto is_repeated = [](const auto& a, const auto& b) { return a.time_ns == b.time_ns; };
    std::stable_sort(all.begin(), all.end(), is_before);
    all.erase(std::unique(all.begin(), all.end(), is_repeated), all.end());
  };
  sort(window.imu);
  sort(window.fixes);
  sort(window.headings);
}

}  // namespace sonopose::motion
