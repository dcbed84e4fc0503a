#include "motion/fit/integral.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace integral_test {

using namespace sonopose;
using namespace sonopose::motion;
using motion::fit::detail::Integral;
using motion::fit::detail::IntegralState;

/// A body that sways and accelerates for eight seconds.
std::vector<Reading> motion_at(double rate_hz) {
  std::vector<Reading> imu;
  for (int i = 0; i <= static_cast<int>(8.0 * rate_hz); ++i) {
    const double time_s = i / rate_hz;
    imu.push_back({.time_ns = to_ns(time_s),
                   .rate_body_radps = Vector3d(0.3 * std::sin(time_s), 0.2 * std::cos(2.0 * time_s), 0.5),
                   .force_body_mps2 = Vector3d(std::sin(1.3 * time_s), std::cos(0.7 * time_s), 9.8)});
  }
  return imu;
}

SCENARIO("an integral whose biases have changed a little is that of the new biases") {
  const double rate_hz = GENERATE(20.0, 100.0);
  const auto imu = motion_at(rate_hz);
  const Vector3d gyro_bias_radps = Vector3d(2.5, -2.5, 2.5) * 1e-4;
  const Vector3d accel_bias_mps2(0.1, -0.1, 0.1);
  Integral integral(imu, Vector3d::Ones());
  integral.set_biases(gyro_bias_radps, accel_bias_mps2);
  auto changed = imu;
  for (Reading& reading : changed) {
    reading.rate_body_radps -= gyro_bias_radps;
    reading.force_body_mps2 -= accel_bias_mps2;
  }
  const Integral right(changed, Vector3d::Ones());
  for (const double time_s :
       {0.0, 3.0, 7.0004, 7.009, 7.04, 8.2}) {  // also between samples, and beyond the end
    CAPTURE(rate_hz, time_s);
    const IntegralState found = integral.at(time_s);
    const IntegralState expected = right.at(time_s);
    CHECK((found.position_m - expected.position_m).norm() < 0.004);
    CHECK((found.velocity_mps - expected.velocity_mps).norm() < 0.002);
    CHECK(found.q_body_to_start.angularDistance(expected.q_body_to_start) < 1e-5);
    CHECK(found.rate_body_radps.isApprox(expected.rate_body_radps));
    CHECK(found.force_body_mps2.isApprox(expected.force_body_mps2));
  }
}

SCENARIO("larger changes of the biases are integrated") {
  const auto imu = motion_at(100.0);
  Integral integral(imu, Vector3d::Ones());
  integral.set_biases(Vector3d(0.02, 0, 0), Vector3d(0, 1, 0));
  integral.set_biases(Vector3d::Zero(), Vector3d::Zero());
  const Integral fresh(imu, Vector3d::Ones());
  CHECK(integral.at(8.0).position_m == fresh.at(8.0).position_m);
}

}  // namespace integral_test
