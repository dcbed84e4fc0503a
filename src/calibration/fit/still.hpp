#pragma once
/// \file
/// The parts of a recording in which the sensor was held still, and how many orientations it was held in.

#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::calibration::fit {

/// One period, and the means over it, all in the axes of the samples given.
struct StillInterval {
  std::size_t begin = 0;  ///< first sample
  std::size_t end = 0;    ///< behind the last sample
  Vector3d mean_rate_radps = Vector3d::Zero();
  Vector3d mean_force_mps2 = Vector3d::Zero();
  double rate_error_radps = 0;  ///< standard error of the mean rate per axis, by the noise alone
  double force_error_mps2 = 0;  ///< the same of the mean force

  [[nodiscard]] std::size_t count() const { return end - begin; }
};

/// The periods in the order of the recording. The endpoints, where the motion begins or fades, are excluded;
/// a gap in the stamps ends a period. Samples that are not finite are never still.
std::vector<StillInterval> find_still_intervals(std::span<const ImuSample> imu);

/// Number of orientations among the periods: gravity's direction is a new one where it stands at least
/// `least_angle_rad` from that of every orientation before.
std::size_t count_orientations(std::span<const StillInterval> intervals, double least_angle_rad);

/// Median of the intervals between stamps (s); 0 for fewer than two samples.
double usual_period_s(std::span<const ImuSample> imu);

}  // namespace sonopose::calibration::fit
