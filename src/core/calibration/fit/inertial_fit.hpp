#pragma once
/// \file
/// Offsets, sensitivities and misalignments from a recording of a sensor held still in many orientations. At
/// rest the gyroscope should read zero and the accelerometer one standard gravity.

#include "calibration/fit/error.hpp"
#include "calibration/fit/still.hpp"
#include <sonopose/calibration/model/inertial.hpp>

#include <cstddef>
#include <span>
#include <string>

namespace sonopose::calibration::fit {

/// Least angle between two distinct orientations.
inline constexpr double min_orientation_angle_rad = 0.15;

/// Orientations needed for offsets and sensitivities, and also for misalignments.
inline constexpr std::size_t min_orientations = 6;
inline constexpr std::size_t min_orientations_with_misalignment = 9;

struct AccelerometerFit {
  AccelerometerSettings settings;
  AccelerometerSettings standard_errors;  ///< standard error of each setting; 0 if it was not estimated
  bool with_misalignment = false;
  std::string why_without;  ///< reason for a fit without misalignment
  std::size_t orientations = 0;
  double rms_before_mps2 = 0;  ///< RMS of |specific force| − standard gravity over the periods
  double rms_after_mps2 = 0;
  double worst_after_mps2 = 0;   ///< largest absolute residual
  std::size_t worst_period = 0;  ///< period with that residual
};

/// Minimises |M·s·(f − b)| − g over the periods' means. The misalignment is a lower triangle: the corrected X
/// axis is the sensor's, and the corrected XY plane holds the sensor's Y. The strength of gravity does not
/// show how the whole sensor is turned. Throws CalibrationError for fewer than six orientations, for
/// orientations that do not determine offsets and sensitivities, and for values that no setting may have.
AccelerometerFit fit_accelerometer(std::span<const StillInterval> intervals);

struct GyroscopeFit {
  GyroscopeSettings settings;
  GyroscopeSettings standard_errors;  ///< standard error of each setting; 0 if it was not estimated
  bool with_sensitivity = false;
  std::string why_without;  ///< reason for a fit without sensitivity and misalignment
  std::size_t periods = 0;
  std::size_t turns = 0;           ///< turns used for sensitivity and misalignment
  std::size_t turns_left_out = 0;  ///< turns left out because the others contradict them
  double rms_before_rad =
      0;  ///< RMS error of gravity's direction after a turn: from the rates, compared with measured
  double rms_after_rad = 0;
};

/// Estimates the offset alone: the mean rate over all still samples. Throws CalibrationError without a
/// period, and for an offset that no setting may have.
GyroscopeFit fit_gyroscope(std::span<const StillInterval> intervals);

/// Estimates the offset, and sensitivity and misalignment from the turns between successive periods: the
/// rates, integrated over a turn, must turn gravity's direction from where it was to where it is. The axes
/// become those of the accelerometer as corrected by `accelerometer`. A turn that the others contradict is
/// left out. Only the offset is estimated if the turns are too few, do not determine the rest, disagree, or
/// yield values that no setting allows. Throws CalibrationError like the offset alone.
GyroscopeFit fit_gyroscope(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                           const AccelerometerSettings& accelerometer);

}  // namespace sonopose::calibration::fit
