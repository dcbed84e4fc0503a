#pragma once
/// \file
/// Magnetometer in its own axes: m_c = S·m_u − h, with the symmetric soft-iron matrix S and the hard-iron
/// offset h, which is subtracted after S. Iron that turns with the sensor makes the readings in a field of
/// constant strength an ellipsoid. If its centre is c, h is S·c.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>

namespace sonopose::calibration {

/// Model in the sensor's own axes, in tesla.
Affine model_of(const MagnetometerSettings& settings);

}  // namespace sonopose::calibration
