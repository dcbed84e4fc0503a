#include <sonopose/calibration/model/axes.hpp>

namespace sonopose::calibration {

Matrix3d sensor_to_body(const AxesSettings& settings) {
  const std::string_view name = choices_of(Axes{})[static_cast<std::size_t>(settings.axes)];
  Matrix3d rotation = Matrix3d::Zero();
  for (std::size_t row = 0; row < 3; ++row) {
    const double sign = name[2 * row] == '-' ? -1.0 : 1.0;
    const int column = name[2 * row + 1] - 'x';
    rotation(static_cast<Eigen::Index>(row), column) = sign;
  }
  return rotation;
}

}  // namespace sonopose::calibration
