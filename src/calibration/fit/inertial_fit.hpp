#pragma once
/// \file
/// Offsets, sensitivities and misalignments from a recording in which the sensor was held still in many
/// orientations: at rest the gyroscope should read zero and the accelerometer one standard gravity.

#include "calibration/fit/error.hpp"
#include "calibration/fit/still.hpp"
#include <sonopose/calibration/model/inertial.hpp>

#include <cstddef>
#include <span>
#include <string>

namespace sonopose::calibration::fit {

/// Least angle between two orientations that count as two.
inline constexpr double least_orientation_angle_rad = 0.15;

/// Orientations for offsets and sensitivities, and for misalignments too.
inline constexpr std::size_t least_orientations = 6;
inline constexpr std::size_t least_orientations_with_misalignment = 9;

struct AccelerometerFit {
  AccelerometerSettings settings;
  AccelerometerSettings standard_errors;  ///< of each setting; 0 for what was not estimated
  bool with_misalignment = false;
  std::string why_without;  ///< without misalignment: the reason
  std::size_t orientations = 0;
  double rms_before_mps2 = 0;  ///< of |specific force| − standard gravity over the periods
  double rms_after_mps2 = 0;
  double worst_after_mps2 = 0;   ///< largest absolute residual …
  std::size_t worst_period = 0;  ///< … and the period that has it
};

/// Minimises |M·s·(f − b)| − g over the periods' means. The misalignment is a lower triangle: the corrected X
/// axis is the sensor's, and the corrected XY plane holds the sensor's Y. The strength of gravity does not
/// show how the whole sensor is turned. Throws CalibrationError for fewer than six orientations, for
/// orientations that do not determine offsets and sensitivities, and for values that no setting may have.
AccelerometerFit fit_accelerometer(std::span<const StillInterval> intervals);

struct GyroscopeFit {
  GyroscopeSettings settings;
  GyroscopeSettings standard_errors;  ///< of each setting; 0 for what was not estimated
  bool with_sensitivity = false;
  std::string why_without;  ///< without sensitivity and misalignment: the reason
  std::size_t periods = 0;
  std::size_t turns = 0;           ///< used for sensitivity and misalignment
  std::size_t turns_left_out = 0;  ///< because the others contradict them
  double rms_before_rad = 0;  ///< gravity's direction after a turn: from the rates, compared with measured
  double rms_after_rad = 0;
};

/// The offset alone: the mean of the rates over all still samples. Throws CalibrationError without a
/// period, and for an offset that no setting may have.
GyroscopeFit fit_gyroscope(std::span<const StillInterval> intervals);

/// The offset, and sensitivity and misalignment from the turns between one period and the next: the
/// rates, integrated over a turn, must turn gravity's direction from where it was to where it is. The
/// axes become those of the accelerometer as `accelerometer` corrects it. A turn that the others
/// contradict is left out. Where there are too few turns, or they do not determine it, or disagree, or
/// yield values that no setting allows, only the offset is estimated. Throws CalibrationError as the
/// offset alone does.
GyroscopeFit fit_gyroscope(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                           const AccelerometerSettings& accelerometer);

}  // namespace sonopose::calibration::fit
