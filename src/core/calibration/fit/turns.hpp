#pragma once
/// \file
/// Turns of a sensor from one still period to the next, and their prediction from the rates. Private to this
/// folder.

#include "calibration/fit/still.hpp"
#include <sonopose/calibration/model/inertial.hpp>

#include <span>
#include <vector>

namespace sonopose::calibration::fit::detail {

/// Samples between two periods, and gravity's direction before and after (unit vectors, body).
struct Turn {
  std::span<const ImuSample> imu;
  Vector3d up_before;
  Vector3d up_after;
};

/// Turns by more than 17° within 30 s, without a gap in the stamps and with finite rates alone.
std::vector<Turn> turns_between(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                                const AccelerometerSettings& accelerometer);

/// Gravity's direction after the turn, predicted from the rates minus measured: three residuals per turn.
Eigen::VectorXd residuals_of(const std::vector<Turn>& turns, const GyroscopeSettings& settings);

}  // namespace sonopose::calibration::fit::detail
