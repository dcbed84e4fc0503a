/// The adaptive filter compared with the documents' filters.

#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/attitude/mahony.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace adaptive_test {

using namespace sonopose;
using namespace sonopose::attitude;

const Vector3d gravity_mps2(0, 0, 9.80665);

double tilt_deg(const Quaterniond& q_body_to_world) {
  return std::acos(std::min(1.0, geometry::up_in_body(q_body_to_world).z())) / geometry::radians_per_degree;
}

Measurement<double> level(const Vector3d& force_mps2, double dt_s = 0.01) {
  Measurement<double> measurement;
  measurement.dt_s = dt_s;
  measurement.specific_force_body_mps2 = force_mps2;
  return measurement;
}

/// Returns the largest tilt of a level filter whose body is accelerated to and fro along X by
/// `amplitude_mps2`.
template <class F>
double tilt_when_shaken(const typename F::Settings& settings, double amplitude_mps2, double frequency_hz) {
  F filter;
  double largest_deg = 0;
  for (int i = 0; i < 6000; ++i) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * 0.01 * i;
    filter.update(settings, level(gravity_mps2 + Vector3d(amplitude_mps2 * std::sin(phase), 0, 0)));
    if (i > 3000) largest_deg = std::max(largest_deg, tilt_deg(filter.orientation()));
  }
  return largest_deg;
}

TEST_CASE("back-and-forth acceleration tilts it much less than a Mahony filter of the same time constant") {
  MahonySettings mahony;
  mahony.kp = 1.0 / AdaptiveSettings{}.accel_time_s;
  mahony.ki = 0;
  const double adaptive_deg = tilt_when_shaken<Adaptive>({}, 3.0, 1.0);
  const double mahony_deg = tilt_when_shaken<Mahony>(mahony, 3.0, 1.0);
  CHECK(adaptive_deg < 0.2);
  CHECK(mahony_deg > 3 * adaptive_deg);
}

TEST_CASE("a body that turns while it is accelerated in one direction of its own stays level") {
  // 2 m/s² along body X at 1 rev/s: a constant lean of 11° in the body, a circle in the world.
  Adaptive filter;
  Measurement<double> measurement = level(gravity_mps2 + Vector3d(2, 0, 0));
  measurement.angular_velocity_body_radps.z() = 2.0 * std::numbers::pi;
  for (int i = 0; i < 3000; ++i) filter.update({}, measurement);
  CHECK(tilt_deg(filter.orientation()) < 0.5);
}

TEST_CASE("a tilt is corrected with the low-pass's time constant") {
  Adaptive filter;
  for (int i = 0; i < 2000; ++i) filter.update({}, level(gravity_mps2));
  GIVEN("a tilt error of 5°") {
    filter.turn_in_world({5.0 * geometry::radians_per_degree, 0, 0});
    const double time_s = AdaptiveSettings{}.accel_time_s;
    THEN("after one time constant much of it remains, after three almost nothing") {
      for (int i = 0; i < static_cast<int>(100 * time_s); ++i) filter.update({}, level(gravity_mps2));
      const double early_deg = tilt_deg(filter.orientation());
      CHECK(early_deg < 4.0);
      CHECK(early_deg > 0.5);
      for (int i = 0; i < static_cast<int>(200 * time_s); ++i) filter.update({}, level(gravity_mps2));
      CHECK(tilt_deg(filter.orientation()) < 0.5);
    }
  }
}

TEST_CASE(
    "sensors at different rates: an accelerometer at a tenth of the gyroscope's rate corrects as fast") {
  const auto tilt_after = [](int accel_every) {
    Adaptive filter;
    Measurement<double> none;
    none.dt_s = 0.005;
    for (int i = 0; i < 4000; ++i)
      filter.update({}, i % accel_every == 0 ? level(gravity_mps2, 0.005) : none);
    filter.turn_in_world({0.1, 0, 0});
    for (int i = 0; i < 400; ++i) filter.update({}, i % accel_every == 0 ? level(gravity_mps2, 0.005) : none);
    return tilt_deg(filter.orientation());
  };
  CHECK(tilt_after(10) == Approx(tilt_after(1)).epsilon(0.05));
}

TEST_CASE("float and double agree") {
  Adaptive in_double;
  BasicAdaptive<float> in_float;
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  for (int i = 0; i < 20'000; ++i) {
    Measurement<double> exact = level(gravity_mps2 + Vector3d(noise(random), noise(random), noise(random)));
    exact.angular_velocity_body_radps = {std::sin(0.01 * i), std::cos(0.013 * i), 0.3};
    Measurement<float> rounded;
    rounded.dt_s = 0.01F;
    rounded.specific_force_body_mps2 = exact.specific_force_body_mps2.cast<float>();
    rounded.angular_velocity_body_radps = exact.angular_velocity_body_radps.cast<float>();
    in_double.update({}, exact);
    in_float.update({}, rounded);
  }
  const Vector3d up_double = geometry::up_in_body(in_double.orientation());
  const Vector3d up_float = geometry::up_in_body(in_float.orientation()).cast<double>();
  CHECK((up_double - up_float).norm() < 1e-3);
}

}  // namespace adaptive_test
