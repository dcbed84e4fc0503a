#include <sonopose/calibration/model/inertial.hpp>

namespace sonopose::calibration {
namespace {

/// The matrix M·s.
Matrix3d matrix_of(const InertialTerms& settings) {
  const Matrix3d misalignment{{1.0, settings.misalignment_xy, settings.misalignment_xz},
                              {settings.misalignment_yx, 1.0, settings.misalignment_yz},
                              {settings.misalignment_zx, settings.misalignment_zy, 1.0}};
  return misalignment *
         Vector3d(settings.sensitivity_x, settings.sensitivity_y, settings.sensitivity_z).asDiagonal();
}

}  // namespace

Affine model_of(const GyroscopeSettings& settings) {
  const Vector3d offset_radps{settings.offset_x_radps, settings.offset_y_radps, settings.offset_z_radps};
  return {matrix_of(settings), offset_radps, Vector3d::Zero()};
}

Affine model_of(const AccelerometerSettings& settings) {
  const Vector3d offset_mps2{settings.offset_x_mps2, settings.offset_y_mps2, settings.offset_z_mps2};
  return {matrix_of(settings), offset_mps2, Vector3d::Zero()};
}

}  // namespace sonopose::calibration
