/// The Mahony filter: gains (items 29 and 30), and the error of the magnetometer.

#include <sonopose/attitude/mahony.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

namespace mahony_test {

using namespace sonopose;
using attitude::Mahony;
using attitude::MahonySettings;

const Vector3d at_rest_mps2(0.0, 0.0, 9.81);

MahonySettings gains(double kp, double ki) {
  MahonySettings settings;
  settings.kp = kp;
  settings.ki = ki;
  return settings;
}

/// Angle between estimated and true up of a level body.
double tilt_of(const Mahony& filter) {
  return std::acos(std::clamp(geometry::up_in_body(filter.orientation()).z(), -1.0, 1.0));
}

Mahony tilted_by(const Vector3d& rotation_rad) {
  Mahony filter;
  filter.reset(geometry::rotation_by(rotation_rad));
  return filter;
}

void update(Mahony& filter, const MahonySettings& settings, const Vector3d& rate_radps,
            const Vector3d& force_mps2, double dt_s) {
  filter.update(
      settings,
      {.dt_s = dt_s, .angular_velocity_body_radps = rate_radps, .specific_force_body_mps2 = force_mps2});
}

void rest(Mahony& filter, const MahonySettings& settings, const Vector3d& rate_radps, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds * 100.0); ++i) {
    update(filter, settings, rate_radps, at_rest_mps2, 0.01);
  }
}

TEST_CASE("item 29: a tilt error decays with the time constant 1/kp, whatever its direction") {
  for (const Vector3d& tilt : {Vector3d(0.05, 0, 0), Vector3d(0, -0.05, 0), Vector3d(-0.03, 0.04, 0)}) {
    for (const double kp : {0.15, 0.5, 2.0}) {
      INFO("tilt " << tilt.transpose() << " kp " << kp);
      Mahony filter = tilted_by(tilt);
      rest(filter, gains(kp, 0.0), Vector3d::Zero(), 1.0 / kp);
      CHECK(tilt_of(filter) / 0.05 == Approx(std::exp(-1.0)).epsilon(0.02));
      rest(filter, gains(kp, 0.0), Vector3d::Zero(), 2.0 / kp);
      CHECK(tilt_of(filter) / 0.05 == Approx(std::exp(-3.0)).epsilon(0.05));
    }
  }
}

TEST_CASE("item 29: gravity says nothing of yaw") {
  Mahony filter;
  filter.reset(geometry::rotation_about_z(1.0) * geometry::rotation_by({0.1, -0.05, 0.0}));
  const double yaw_rad = geometry::yaw_of(filter.orientation());
  rest(filter, gains(1.0, 0.01), Vector3d::Zero(), 20.0);
  CHECK(tilt_of(filter) < 1e-3);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(yaw_rad).margin(0.02));
}

TEST_CASE("item 30: a constant gyro offset is removed over tens of seconds") {
  const Vector3d offset_radps(0.01, -0.02, 0.0);
  GIVEN("a filter without integral gain") {
    Mahony filter;
    rest(filter, gains(0.15, 0.0), offset_radps, 300.0);
    THEN("it stands tilted by offset / kp for ever") {
      CHECK(tilt_of(filter) == Approx(offset_radps.norm() / 0.15).epsilon(0.02));
      CHECK(filter.gyro_bias_body_radps().norm() == 0.0);
    }
  }
  GIVEN("a filter with the document's typical gain") {
    Mahony filter;
    rest(filter, gains(0.15, 0.005), offset_radps, 10.0);
    const double early_rad = tilt_of(filter);
    rest(filter, gains(0.15, 0.005), offset_radps, 110.0);
    THEN("the offset is found and the tilt gone") {
      CHECK((filter.gyro_bias_body_radps() - offset_radps).norm() < 0.03 * offset_radps.norm());
      CHECK(tilt_of(filter) < 0.05 * early_rad);
    }
  }
}

TEST_CASE("no force, no correction; no time, no change") {
  Mahony filter = tilted_by({0.2, 0.1, 0.0});
  const Mahony before = filter;
  update(filter, gains(1.0, 0.1), Vector3d::Zero(), Vector3d::Zero(), 0.01);
  CHECK(filter.orientation().angularDistance(before.orientation()) < 1e-15);
  CHECK(filter.gyro_bias_body_radps() == before.gyro_bias_body_radps());
  update(filter, gains(1.0, 0.1), Vector3d(1, 2, 3), at_rest_mps2, 0.0);
  CHECK(filter.orientation().angularDistance(before.orientation()) < 1e-15);
}

/// A level body at rest in a field of 20 µT north and 40 µT down, plus a disturbance.
attitude::Measurement<double> in_field(const Vector3d& disturbance_t) {
  attitude::Measurement<double> measurement;
  measurement.dt_s = 0.01;
  measurement.specific_force_body_mps2 = at_rest_mps2;
  measurement.magnetic_field_body_t = Vector3d(0, 20e-6, -40e-6) + disturbance_t;
  return measurement;
}

TEST_CASE("the magnetometer's heading gain is a rate, apart from item 29") {
  MahonySettings settings = gains(5.0, 0.0);
  settings.heading_kp = 0.2;
  Mahony filter;
  filter.turn_in_world({0, 0, 0.05});
  for (int i = 0; i < 500; ++i) filter.update(settings, in_field(Vector3d::Zero()));
  CHECK(geometry::yaw_of(filter.orientation()) / 0.05 == Approx(std::exp(-1.0)).epsilon(0.02));
}

TEST_CASE("a disturbed field tilts the classic filter and only turns the default one") {
  // A magnet of 20 µT to the east: north appears 45° off, and the dip differs.
  GIVEN("the error on heading alone") {
    MahonySettings settings = gains(0.5, 0.0);
    settings.heading_kp = 0.5;
    settings.magnetic_error = attitude::MagneticError::heading;
    Mahony filter;
    for (int i = 0; i < 20'000; ++i) filter.update(settings, in_field({20e-6, 0, 0}));
    THEN("heading follows the magnet, and the body stays level") {
      CHECK(tilt_of(filter) < 1e-6);
      CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.785398).epsilon(0.01));
    }
  }
  GIVEN("the classic error of all axes") {
    MahonySettings settings = gains(0.5, 0.0);
    settings.magnetic_error = attitude::MagneticError::full;
    Mahony filter;
    filter.turn_in_world({0, 0, 1.0});
    double largest_rad = 0;
    for (int i = 0; i < 10'000; ++i) {
      filter.update(settings, in_field({20e-6, 0, 0}));
      largest_rad = std::max(largest_rad, tilt_of(filter));
    }
    THEN("it tilts while heading turns") {
      CHECK(largest_rad > 0.03);
      CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.785398).epsilon(0.01));
    }
  }
}

}  // namespace mahony_test
