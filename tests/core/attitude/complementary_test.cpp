/// The document's blend and the effect of alpha at other step lengths.

#include <sonopose/attitude/complementary.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace complementary_test {

using namespace sonopose;
using namespace sonopose::attitude;

Measurement<double> level(double dt_s) {
  Measurement<double> measurement;
  measurement.dt_s = dt_s;
  measurement.specific_force_body_mps2 = {0, 0, 9.80665};
  return measurement;
}

ComplementarySettings with_alpha(double alpha, double step_s) {
  ComplementarySettings settings;
  settings.alpha = alpha;
  settings.alpha_step_s = step_s;
  return settings;
}

TEST_CASE("one step leaves alpha of a tilt and alpha of a heading error") {
  for (const double alpha : {0.0, 0.5, 0.98, 1.0}) {
    Complementary filter;
    Measurement<double> measurement = level(0.01);
    measurement.magnetic_field_body_t = {0, 20e-6, 0};
    const geometry::EulerAngles<double> off{0.3, 0.0, 0.0};
    filter.reset(geometry::rotation_of(off));
    measurement.magnetic_field_body_t = {0, 20e-6, -40e-6};
    filter.update(with_alpha(alpha, 0.01), measurement);
    INFO("alpha " << alpha);
    CHECK(geometry::euler_angles_of(filter.orientation()).roll_rad == Approx(alpha * 0.3).margin(1e-12));

    filter.reset(geometry::rotation_about_z(-0.4));
    filter.update(with_alpha(alpha, 0.01), measurement);
    CHECK(geometry::yaw_of(filter.orientation()) == Approx(alpha * -0.4).margin(1e-12));
  }
}

TEST_CASE("alpha counts for its own step: ten short steps are one long") {
  const auto tilt_after = [](int steps, double dt_s) {
    Complementary filter;
    filter.reset(geometry::rotation_by({0.2, 0.0, 0.0}));
    for (int i = 0; i < steps; ++i) filter.update(with_alpha(0.9, 0.01), level(dt_s));
    return geometry::euler_angles_of(filter.orientation()).roll_rad;
  };
  CHECK(tilt_after(10, 0.001) == Approx(tilt_after(1, 0.01)).epsilon(1e-9));
  CHECK(tilt_after(1, 0.02) == Approx(0.9 * 0.9 * 0.2).epsilon(1e-9));
}

TEST_CASE("roll and pitch are those of the document's formulas, yaw that of the compensated field") {
  // After a long standstill the filter shows the sensors' own attitude.
  const geometry::EulerAngles<double> truth{0.5, -0.7, 2.0};
  const Quaterniond q = geometry::rotation_of(truth);
  Measurement<double> measurement = level(0.01);
  const Vector3d force = q.conjugate() * Vector3d(0, 0, 9.80665);
  measurement.specific_force_body_mps2 = force;
  measurement.magnetic_field_body_t = q.conjugate() * Vector3d(0, 20e-6, -40e-6);
  Complementary filter;
  for (int i = 0; i < 5000; ++i) filter.update(with_alpha(0.99, 0.01), measurement);
  const auto seen = geometry::euler_angles_of(filter.orientation());
  CHECK(seen.roll_rad == Approx(std::atan2(force.y(), force.z())).margin(1e-6));
  CHECK(seen.pitch_rad == Approx(-std::atan2(force.x(), std::hypot(force.y(), force.z()))).margin(1e-6));
  CHECK(seen.yaw_rad == Approx(2.0).margin(1e-6));
}

}  // namespace complementary_test
