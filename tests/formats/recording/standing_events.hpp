#pragma once
/// \file
/// Events of a body at rest, for tests of the checks of input.

#include <sonopose/samples/samples.hpp>

#include <cmath>
#include <vector>

namespace sonopose::test {

inline constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// Noise of about a thousandth: no sensor repeats one value.
inline double noise(int i) {
  return 1e-3 * std::sin(i);
}

/// Ten seconds of a body at rest: IMU at 100 Hz, fixes at 8 Hz.
inline std::vector<Event> standing() {
  std::vector<Event> events;
  for (int i = 0; i < 1000; ++i) {
    ImuSample imu;
    imu.sensor_time_ns = start_ns + i * 10'000'000LL;
    imu.specific_force_body_mps2 = Vector3d(0.0, 0.0, standard_gravity_mps2) + Vector3d::Constant(noise(i));
    imu.angular_velocity_body_radps.setConstant(noise(i));
    events.emplace_back(imu);
    if (i % 12 != 0) continue;
    UltrasonicFix fix;
    fix.emission_time_ns = imu.sensor_time_ns;
    fix.received_time_ns = imu.sensor_time_ns + 70'000'000;
    events.emplace_back(fix);
  }
  return events;
}

}  // namespace sonopose::test
