#pragma once
/// \file
/// Allan deviation: the kind of noise of a sensor at rest, from the differences between the means of
/// neighbouring clusters of samples. Source: IEEE Std 952-1997, annex C.

#include "calibration/fit/error.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sonopose::calibration::fit {

/// One point of the curve.
struct AllanPoint {
  double tau_s = 0;           ///< length of a cluster
  double deviation = 0;       ///< deviation in the samples' unit
  double relative_error = 0;  ///< standard error of the deviation, as a share of it
};

/// Overlapping Allan deviation of samples `period_s` apart. Cluster lengths are evenly spaced on a
/// logarithmic scale, from one sample to a ninth of the record. Empty for fewer than 27 samples.
std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double period_s);

/// The usual numbers; U is the samples' unit. Empty if the record does not show one.
struct AllanNumbers {
  std::optional<double> noise_density;           ///< U/√Hz: at slope −1/2, read at τ = 1 s
  std::optional<double> bias_instability;        ///< U: floor of the curve over 0.664
  std::optional<double> bias_instability_tau_s;  ///< τ of the floor
  std::optional<double> rate_random_walk;        ///< U/s·√s: at slope +1/2, read at τ = 3 s
};

/// Reads the numbers off a curve. A slope counts if it lasts for half a decade. A floor counts if the curve
/// leaves the line of the noise density by more than its own error and has stopped falling.
AllanNumbers allan_numbers(std::span<const AllanPoint> curve);

/// Six axes of an IMU in the order of `allan_axes`.
inline constexpr std::array<std::string_view, 6> allan_axes{
    "gyroscope x", "gyroscope y", "gyroscope z", "accelerometer x", "accelerometer y", "accelerometer z"};

struct AllanReport {
  double period_s = 0;  ///< mean period
  double duration_s = 0;
  std::array<std::vector<AllanPoint>, 6> curves;
  std::array<AllanNumbers, 6> numbers;
};

/// Analyses a record at rest. Throws CalibrationError for fewer than 1000 samples, a sample that is not
/// finite, stamps that are not uniform (each must come within half a period of its time after the one
/// before), and a sensor that is not at rest.
AllanReport analyse_allan(std::span<const ImuSample> imu);

}  // namespace sonopose::calibration::fit
