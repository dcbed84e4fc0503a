#pragma once
/// \file
/// The parts of a recording in which the sensor was held still, and the number of its orientations.

#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::calibration::fit {

/// One period and its means, in the axes of the given samples.
struct StillInterval {
  std::size_t begin = 0;  ///< first sample
  std::size_t end = 0;    ///< one past the last sample
  Vector3d mean_rate_radps = Vector3d::Zero();
  Vector3d mean_force_mps2 = Vector3d::Zero();
  double rate_error_radps = 0;  ///< standard error of the mean rate per axis, by the noise alone
  double force_error_mps2 = 0;  ///< standard error of the mean force per axis, by the noise alone

  [[nodiscard]] std::size_t count() const { return end - begin; }
};

/// Finds the periods, in the order of the recording. Their endpoints, where motion begins or fades, are
/// excluded. A gap in the stamps ends a period. Samples that are not finite are never still.
std::vector<StillInterval> find_still_intervals(std::span<const ImuSample> imu);

/// Number of orientations among the periods. Gravity's direction is a new one if it is at least
/// `min_angle_rad` from that of every orientation before.
std::size_t count_orientations(std::span<const StillInterval> intervals, double min_angle_rad);

/// Median of the intervals between stamps (s); 0 for fewer than two samples.
double usual_period_s(std::span<const ImuSample> imu);

}  // namespace sonopose::calibration::fit
