#pragma once
/// \file
/// How the sensor is mounted, in multiples of 90°: which of the sensor's axes each axis of the body is.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>

namespace sonopose::calibration {

/// R of v_body = R·v_sensor.
Matrix3d sensor_to_body(const AxesSettings& settings);

}  // namespace sonopose::calibration
