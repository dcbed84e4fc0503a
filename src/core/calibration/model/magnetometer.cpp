#include <sonopose/calibration/model/magnetometer.hpp>

namespace sonopose::calibration {

Affine model_of(const MagnetometerSettings& settings) {
  constexpr double tesla_per_microtesla = 1e-6;
  const Matrix3d soft_iron{{settings.soft_iron_xx, settings.soft_iron_xy, settings.soft_iron_xz},
                           {settings.soft_iron_xy, settings.soft_iron_yy, settings.soft_iron_yz},
                           {settings.soft_iron_xz, settings.soft_iron_yz, settings.soft_iron_zz}};
  const Vector3d hard_iron_ut{settings.hard_iron_x_ut, settings.hard_iron_y_ut, settings.hard_iron_z_ut};
  return {soft_iron, Vector3d::Zero(), tesla_per_microtesla * hard_iron_ut};
}

}  // namespace sonopose::calibration
