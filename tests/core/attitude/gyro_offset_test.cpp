/// The AHRS document's gyroscope offset correction.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

namespace gyro_offset_test {

using namespace sonopose;
using namespace sonopose::testing;

using Offset = attitude::GyroOffset<double>;

const attitude::GyroOffsetLimits<double> limits{3 * degree, 5.0, 0.02};

void learn(Offset& offset, const Vector3d& rate_radps, double seconds, double dt_s = step_s) {
  for (long i = 0; i < std::lround(seconds / dt_s); ++i) offset.learn(limits, rate_radps, dt_s);
}

TEST_CASE("an offset is learned at rest, after 5 s, with the low-pass filter's time constant") {
  const Vector3d truth(1 * degree, -0.5 * degree, 0.2 * degree);
  const double time_constant_s = 1.0 / (2.0 * std::numbers::pi * 0.02);
  for (const double dt_s : {0.001, 0.01, 0.1}) {
    Offset offset;
    learn(offset, truth, 4.9, dt_s);
    CHECK(offset.offset_body_radps == Vector3d::Zero());
    learn(offset, truth, 0.1 + time_constant_s, dt_s);
    CHECK((truth - offset.offset_body_radps).norm() / truth.norm() == Approx(std::exp(-1.0)).epsilon(0.02));
    learn(offset, truth, 6 * time_constant_s, dt_s);
    CHECK((truth - offset.offset_body_radps).norm() < 0.002 * truth.norm());
  }
}

TEST_CASE("nothing is learned while any rate exceeds the limit") {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, 1)}) {
    Offset offset;
    learn(offset, 3.1 * degree * axis, 60.0);
    CHECK(offset.offset_body_radps == Vector3d::Zero());
    learn(offset, 2.9 * degree * axis, 60.0);
    CHECK(offset.offset_body_radps.norm() > 2 * degree);
  }
}

TEST_CASE("a movement begins the waiting again") {
  Offset offset;
  for (int i = 0; i < 20; ++i) {
    learn(offset, Vector3d(1 * degree, 0, 0), 4.0);
    learn(offset, Vector3d(30 * degree, 0, 0), 0.1);
  }
  CHECK(offset.offset_body_radps == Vector3d::Zero());
}

TEST_CASE("the limit is for what remains: a large offset that is known is followed") {
  Offset offset;
  offset.offset_body_radps = {10 * degree, 0, 0};
  learn(offset, Vector3d(11 * degree, 0, 0), 120.0);
  CHECK(offset.offset_body_radps.x() == Approx(11 * degree).epsilon(0.001));
}

TEST_CASE("a step of any length does not go beyond the measurement") {
  Offset offset;
  learn(offset, Vector3d(1 * degree, 0, 0), 10000.0, 100.0);
  CHECK(offset.offset_body_radps.x() <= 1 * degree);
  CHECK(offset.offset_body_radps.x() == Approx(1 * degree));
}

TEST_CASE("the filter learns its gyroscope's offset, and not where that is switched off") {
  const Vector3d truth(1 * degree, -0.5 * degree, 0.2 * degree);
  auto m = at_rest(Quaterniond::Identity());
  m.angular_velocity_body_radps = truth;
  AhrsSettings settings;
  Ahrs filter;
  run(filter, settings, m, 120.0);
  CHECK((filter.gyro_bias_body_radps() - truth).norm() < 0.001 * truth.norm());
  CHECK(distance_rad(filter, Quaterniond::Identity()) < 0.01 * degree);
  settings.gyro_offset = false;
  filter.reset(Quaterniond::Identity());
  run(filter, settings, m, 120.0);
  CHECK(filter.gyro_bias_body_radps() == Vector3d::Zero());
  // Equilibrium between the accelerometer's correction and the uncorrected offset.
  CHECK(tilt_error_rad(filter, Quaterniond::Identity()) ==
        Approx(truth.head<2>().norm() / settings.gain).epsilon(0.02));
}

TEST_CASE("the filter's settings are the offset's limits") {
  auto m = gyroscope_alone(at_rest(Quaterniond::Identity()));
  m.angular_velocity_body_radps = {8 * degree, 0, 0};
  AhrsSettings settings;
  Ahrs filter;
  run(filter, settings, m, 20.0);
  CHECK(filter.gyro_bias_body_radps().norm() == 0.0);
  settings.gyro_offset_limit_dps = 9.0;
  settings.gyro_offset_still_s = 2.0;
  settings.gyro_offset_cutoff_hz = 1.0;
  run(filter, settings, m, 1.9);
  CHECK(filter.gyro_bias_body_radps().norm() == 0.0);
  run(filter, settings, m, 1.1);
  CHECK(filter.gyro_bias_body_radps().x() == Approx(8 * degree).epsilon(0.005));
}

}  // namespace gyro_offset_test
