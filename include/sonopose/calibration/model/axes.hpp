#pragma once
/// \file
/// The mounting of the sensor in multiples of 90°: which of its axes each body axis is.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>

namespace sonopose::calibration {

/// Rotation matrix R of v_body = R·v_sensor.
Matrix3d sensor_to_body(const AxesSettings& settings);

}  // namespace sonopose::calibration
