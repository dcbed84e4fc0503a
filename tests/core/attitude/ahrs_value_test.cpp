/// The AHRS as a value: set, read and compared, at any step, in both precisions.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <type_traits>

namespace ahrs_value_test {

using namespace sonopose;
using namespace sonopose::testing;

/// A body that swings about all axes, in closed form.
Quaterniond swinging(double t) {
  return geometry::rotation_about_z(0.8 * std::sin(0.9 * t)) *
         geometry::rotation_by({0.5 * std::sin(1.3 * t), 0.0, 0.0}) *
         geometry::rotation_by({0.0, 0.4 * std::sin(0.7 * t), 0.0});
}

/// Sensors over the step from `t − dt_s` to `t`: the mean rate, as an integrating gyroscope reports it.
attitude::Measurement<double> sensed(double t, double dt_s) {
  auto m = at_rest(swinging(t));
  const Eigen::AngleAxisd turned(swinging(t - dt_s).conjugate() * swinging(t));
  m.dt_s = dt_s;
  m.angular_velocity_body_radps = turned.angle() / dt_s * turned.axis();
  return m;
}

template <class Scalar>
attitude::Measurement<Scalar> in_precision(const attitude::Measurement<double>& m) {
  return {static_cast<Scalar>(m.dt_s), m.angular_velocity_body_radps.cast<Scalar>(),
          m.specific_force_body_mps2.cast<Scalar>(), m.magnetic_field_body_t.cast<Scalar>(),
          m.north_world.cast<Scalar>()};
}

TEST_CASE("a steady step and one that varies end at the same orientation") {
  Ahrs steady;
  Ahrs varying;
  double t = 0.0;
  for (int i = 1; i <= 30000; ++i) {
    steady.update({}, sensed(1e-3 * i, 1e-3));
    const double dt_s = i % 2 == 1 ? 0.3e-3 : 1.7e-3;
    t += dt_s;
    varying.update({}, sensed(t, dt_s));
  }
  // Measurements are compared with the orientation before their step: at 1.2 rad/s at most 1.7 ms old.
  CHECK(distance_rad(steady, swinging(30.0)) < 1.2 * 1.7e-3);
  CHECK(distance_rad(varying, steady.orientation()) < 1.2 * 0.7e-3);
}

TEST_CASE("float agrees with double") {
  attitude::BasicAhrs<float> coarse;
  Ahrs fine;
  for (int i = 1; i <= 3000; ++i) {
    const auto m = sensed(0.01 * i, 0.01);
    coarse.update({}, in_precision<float>(m));
    fine.update({}, m);
    CHECK(coarse.orientation().cast<double>().angularDistance(fine.orientation()) < 1e-4);
  }
  CHECK(coarse.flags({}).initialising == fine.flags({}).initialising);
}

TEST_CASE("a step of any length pulls no further than its errors") {
  const Quaterniond truth = geometry::rotation_by({0.1, 0.05, 0.1});
  Ahrs filter;
  auto m = at_rest(truth);
  m.dt_s = 1.0;  // ten times the longest stable step at a gain of 10
  for (int i = 0; i < 3; ++i) filter.update({}, m);
  CHECK(distance_rad(filter, truth) < 0.01);
  m.dt_s = 0.0;
  const Quaterniond before = filter.orientation();
  filter.update({}, m);
  CHECK(distance_rad(filter, before) < 1e-15);
}

TEST_CASE("every field of the state counts in a comparison") {
  const Ahrs plain;
  int fields = 0;
  plain.for_each_field([&fields](const char* /*name*/, const auto& /*field*/) { ++fields; });
  for (int changed = 0; changed < fields; ++changed) {
    Ahrs other;
    int index = 0;
    std::string of;
    other.for_each_field([&](const char* name, auto& field) {
      if (index++ != changed) return;
      of = name;
      using Type = std::decay_t<decltype(field)>;
      if constexpr (std::is_same_v<Type, Quaterniond>)
        field = Quaterniond(0, 1, 0, 0);
      else if constexpr (std::is_same_v<Type, Vector3d>)
        field.z() = 0.5;
      else if constexpr (std::is_same_v<Type, bool>)
        field = !field;
      else
        field = static_cast<Type>(0.5);
    });
    INFO(of);
    CHECK_FALSE(other == plain);
  }
}

TEST_CASE("a reset normalises what it is given") {
  Ahrs filter;
  filter.reset(Quaterniond(2, 0, 0, 0));
  CHECK(filter == Ahrs{});
}

TEST_CASE("a heading that is set changes the yaw alone") {
  Ahrs filter = settled_at(swinging(1.0));
  run(filter, {}, at_rest(swinging(3.0)), 1.0);
  const Ahrs before = filter;
  const Vector3d up_before = geometry::up_in_body(filter.orientation());
  filter.set_heading(-2.5);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(-2.5));
  CHECK((geometry::up_in_body(filter.orientation()) - up_before).norm() < 1e-12);
  filter.turn_in_world({0, 0, 1});
  filter.for_each_field([&before](const char* /*name*/, auto& field) {
    if constexpr (std::is_same_v<std::decay_t<decltype(field)>, Quaterniond>) field = before.orientation();
  });
  CHECK(filter == before);
}

TEST_CASE("a bias that is set is taken off, whether or not the filter learns") {
  AhrsSettings settings;
  settings.gyro_offset = false;
  Ahrs filter = settled_at(Quaterniond::Identity(), settings);
  filter.set_gyro_bias({0.01, -0.02, 0.5});
  attitude::Measurement<double> m;
  m.dt_s = step_s;
  m.angular_velocity_body_radps = {0.01, -0.02, 0.5};
  run(filter, settings, m, 60.0);
  CHECK(distance_rad(filter, Quaterniond::Identity()) < rounding_rad);
  CHECK(filter.gyro_bias_body_radps() == Vector3d(0.01, -0.02, 0.5));
}

}  // namespace ahrs_value_test
