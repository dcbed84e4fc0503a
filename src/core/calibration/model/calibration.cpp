#include <sonopose/calibration/model/axes.hpp>
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/calibration/model/inertial.hpp>
#include <sonopose/calibration/model/magnetometer.hpp>

#include <type_traits>

namespace sonopose::calibration {

static_assert(std::is_trivially_copyable_v<Calibration>);

Calibration::Calibration(const Settings& settings) {
  const Matrix3d rotation = sensor_to_body(settings.axes);
  gyroscope_ = model_of(settings.gyroscope).turned_by(rotation);
  accelerometer_ = model_of(settings.accelerometer).turned_by(rotation);
  magnetometer_ = model_of(settings.magnetometer).turned_by(rotation);
}

ImuSample Calibration::corrected(const ImuSample& raw) const noexcept {
  ImuSample sample = raw;
  sample.angular_velocity_body_radps = gyroscope_(raw.angular_velocity_body_radps);
  sample.specific_force_body_mps2 = accelerometer_(raw.specific_force_body_mps2);
  if (raw.magnetic_field_body_t) sample.magnetic_field_body_t = magnetometer_(*raw.magnetic_field_body_t);
  return sample;
}

}  // namespace sonopose::calibration
