/// The gyroscope's offset, learned at rest and in motion.

#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace bias_test {

using namespace sonopose;
using namespace sonopose::attitude;

const Vector3d gravity_mps2(0, 0, 9.80665);
constexpr double dps = geometry::radians_per_degree;
const Vector3d offset_radps(0.6 * dps, -0.4 * dps, 0.5 * dps);

/// A body that turns with `rate(t)` about its own axes, measured by a gyroscope with the offset.
template <class Rate>
Adaptive after(double duration_s, const Rate& rate) {
  Adaptive filter;
  Quaterniond truth = Quaterniond::Identity();
  for (int i = 0; i < static_cast<int>(duration_s * 100); ++i) {
    Measurement<double> measurement;
    measurement.dt_s = 0.01;
    const Vector3d rate_radps = rate(0.01 * i);
    truth = truth * geometry::rotation_by(rate_radps * 0.01);
    measurement.angular_velocity_body_radps = rate_radps + offset_radps;
    measurement.specific_force_body_mps2 = truth.conjugate() * gravity_mps2;
    filter.update({}, measurement);
  }
  return filter;
}

Vector3d still(double /*time_s*/) {
  return Vector3d::Zero();
}

TEST_CASE("at rest the offset is found about all three axes, in seconds") {
  const Adaptive filter = after(10.0, still);
  CHECK((filter.gyro_bias_body_radps() - offset_radps).norm() < 0.05 * dps);
}

TEST_CASE("in motion the offset is found about the axes that are level at some time") {
  const auto tumbling = [](double time_s) {
    return Vector3d(std::sin(0.7 * time_s), std::cos(0.9 * time_s), 0.8 * std::sin(0.4 * time_s));
  };
  const Adaptive filter = after(300.0, tumbling);
  CHECK((filter.gyro_bias_body_radps() - offset_radps).norm() < 0.1 * dps);
}

TEST_CASE("turning about the vertical shows nothing of the offset there, and is not taken for one") {
  // 1 deg/s could be an offset, so a steady reading alone does not prove rest.
  const auto turning = [](double time_s) { return Vector3d(0, 0, time_s > 20.0 ? 30.0 * dps : 0.0); };
  const Adaptive filter = after(60.0, turning);
  CHECK(std::abs(filter.gyro_bias_body_radps().z() - offset_radps.z()) < 0.2 * dps);
}

TEST_CASE("no offset beyond the limit is learned") {
  Adaptive filter;
  Adaptive::Settings settings;
  settings.bias.limit_dps = 0.3;
  Measurement<double> measurement;
  measurement.dt_s = 0.01;
  measurement.angular_velocity_body_radps.x() = 0.25 * dps;
  measurement.angular_velocity_body_radps.y() = 0.9 * dps;
  measurement.specific_force_body_mps2 = gravity_mps2;
  for (int i = 0; i < 6000; ++i) filter.update(settings, measurement);
  CHECK(filter.gyro_bias_body_radps().cwiseAbs().maxCoeff() <= 0.3 * dps + 1e-12);
}

}  // namespace bias_test
