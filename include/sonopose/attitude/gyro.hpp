#pragma once
/// \file
/// The gyroscope alone, without corrections: the orientation half of the strapdown document (equations 3 and
/// 4) as a filter.

#include <sonopose/attitude/integrated_attitude.hpp>

namespace sonopose::attitude {

/// This filter has no settings.
struct GyroSettings {};

/// The filter uses the given gyroscope offset and learns none.
template <class Number>
class BasicGyro : public IntegratedAttitude<Number> {
public:
  using Settings = GyroSettings;
  static constexpr std::string_view name = "gyro";

  void update(const Settings& /*settings*/, const Measurement<Number>& measurement) {
    this->turn_in_body((measurement.angular_velocity_body_radps - this->gyro_bias_body_radps_) *
                       measurement.dt_s);
  }
};

using Gyro = BasicGyro<double>;

}  // namespace sonopose::attitude
