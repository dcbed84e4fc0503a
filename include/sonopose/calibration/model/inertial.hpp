#pragma once
/// \file
/// Gyroscope and accelerometer, each in its own axes: i_c = M·s·(i_u − b), with the offset b, the diagonal
/// matrix of sensitivities s and the misalignment M, whose diagonal is 1.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>

namespace sonopose::calibration {

/// Models in the sensors' own axes, in rad/s and m/s².
Affine model_of(const GyroscopeSettings& settings);
Affine model_of(const AccelerometerSettings& settings);

}  // namespace sonopose::calibration
