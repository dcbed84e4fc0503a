/// The AHRS document's algorithm: initialisation and the correction by each sensor.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

namespace ahrs_test {

using namespace sonopose;
using namespace sonopose::testing;

const Quaterniond somewhere = geometry::rotation_about_z(2.0) * geometry::rotation_by({0.4, -0.7, 0.0});

/// A settled filter `seconds` after it was turned by the error.
Ahrs after_error(const AhrsSettings& settings, const Vector3d& error_world_rad, double seconds) {
  Ahrs filter = settled_at(somewhere, settings);
  filter.turn_in_world(error_world_rad);
  run(filter, settings, at_rest(somewhere), seconds);
  return filter;
}

TEST_CASE("initialisation converges within its 3 s from any orientation") {
  const Eigen::Vector2d north = Eigen::Vector2d(-0.6, 0.8);
  for (const Vector3d& start : {Vector3d(0, 0, 0), Vector3d(3.0, 0, 0), Vector3d(0, -1.5, 0.3),
                                Vector3d(0, 0, 3.0), Vector3d(1.8, 1.8, 1.8)}) {
    INFO("from " << start.transpose());
    Ahrs filter;
    filter.reset(geometry::rotation_by(start));
    run(filter, {}, at_rest(somewhere, north), 3.0);
    CHECK(distance_rad(filter, somewhere) < 1.0 * degree);
    run(filter, {}, at_rest(somewhere, north), 20.0);
    CHECK(distance_rad(filter, somewhere) < 1e-4);
  }
}

TEST_CASE("the filter also leaves an estimate that is exactly upside down or exactly backwards") {
  Ahrs filter;
  const Quaterniond upside_down(0, 1, 0, 0);
  run(filter, {}, at_rest(upside_down), 10.0);
  CHECK(distance_rad(filter, upside_down) < 0.01);
  Ahrs other;
  const Quaterniond backwards(0, 0, 0, 1);
  run(other, {}, at_rest(backwards), 10.0);
  CHECK(distance_rad(other, backwards) < 0.01);
}

TEST_CASE("the gain falls from 10 to its final value over 3 s") {
  AhrsSettings settings;
  settings.acceleration_rejection_deg = 0.0;
  const Quaterniond truth = geometry::rotation_by({std::numbers::pi / 2, 0, 0});
  for (const double seconds : {0.5, 1.0, 2.0, 2.9, 3.2}) {
    Ahrs filter;
    filter.reset(truth);
    run(filter, settings, gyroscope_alone(at_rest(truth)), seconds);
    CHECK(filter.flags(settings).initialising == (seconds < 3.0));
    // A contradiction of 90° is corrected at the rate of the gain.
    filter.update(settings, without_field(at_rest(Quaterniond::Identity())));
    const double gain_hz = std::max(10.0 - (10.0 - settings.gain) * (seconds + step_s) / 3.0, settings.gain);
    CHECK(tilt_error_rad(filter, truth) == Approx(gain_hz * step_s).epsilon(0.01));
  }
}

TEST_CASE("an error decays with the time constant 1/gain, of tilt and of heading alike") {
  for (const double gain : {0.2, 0.5, 2.0}) {
    AhrsSettings settings;
    settings.gain = gain;
    for (const Vector3d& error : {Vector3d(0.05, 0, 0), Vector3d(0, -0.05, 0)}) {
      INFO("gain " << gain << " error " << error.transpose());
      const Ahrs after_one = after_error(settings, error, 1.0 / gain);
      CHECK(tilt_error_rad(after_one, somewhere) / 0.05 == Approx(std::exp(-1.0)).epsilon(0.03));
      const Ahrs after_three = after_error(settings, error, 3.0 / gain);
      CHECK(tilt_error_rad(after_three, somewhere) / 0.05 == Approx(std::exp(-3.0)).epsilon(0.06));
    }
    // Heading alone: with a tilt error, the field's dip would appear as heading.
    const Ahrs after_one = after_error(settings, {0, 0, 0.05}, 1.0 / gain);
    CHECK(distance_rad(after_one, somewhere) / 0.05 == Approx(std::exp(-1.0)).epsilon(0.03));
    const Ahrs after_three = after_error(settings, {0, 0, 0.05}, 3.0 / gain);
    CHECK(distance_rad(after_three, somewhere) / 0.05 == Approx(std::exp(-3.0)).epsilon(0.06));
  }
}

TEST_CASE("beyond 90 degrees the pull does not fade") {
  AhrsSettings settings;
  settings.acceleration_rejection_deg = 0.0;
  settings.magnetic_rejection_deg = 0.0;
  for (const double angle : {100.0 * degree, 179.0 * degree}) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 0, 1)}) {
      const Ahrs filter = after_error(settings, angle * axis, 0.1);
      CHECK(angle - distance_rad(filter, somewhere) == Approx(0.1 * settings.gain).epsilon(0.01));
    }
  }
}

TEST_CASE("gravity says nothing of heading, the field nothing of tilt") {
  Ahrs filter;
  filter.reset(geometry::rotation_about_z(1.0) * geometry::rotation_by({0.1, -0.05, 0.0}));
  run(filter, {}, without_field(at_rest(Quaterniond::Identity())), 20.0);
  CHECK(tilt_error_rad(filter, Quaterniond::Identity()) < 1e-4);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(1.0).margin(0.01));

  filter = settled_at(somewhere);
  auto disturbed = at_rest(somewhere);
  disturbed.magnetic_field_body_t = Vector3d(30e-6, -60e-6, 10e-6);
  AhrsSettings settings;
  settings.magnetic_rejection_deg = 0.0;
  run(filter, settings, disturbed, 10.0);
  CHECK(distance_rad(filter, somewhere) > 0.1);
  CHECK(tilt_error_rad(filter, somewhere) < rounding_rad);
}

TEST_CASE("a field before any force is not used: up is not known yet") {
  auto m = at_rest(Quaterniond::Identity());
  m.specific_force_body_mps2.setZero();
  Ahrs filter;
  filter.reset(geometry::rotation_about_z(1.0));
  run(filter, {}, m, 1.0);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(1.0));
  filter.update({}, without_field(at_rest(Quaterniond::Identity())));
  run(filter, {}, m, 5.0);
  CHECK(std::abs(geometry::yaw_of(filter.orientation())) < 0.01);
}

TEST_CASE("sensors may come at different rates: a step without one neither pulls nor counts") {
  AhrsSettings settings;
  Ahrs filter = settled_at(somewhere);
  filter.turn_in_world({0.0, 0.0, 0.05});
  filter.turn_in_world({0.05, 0.0, 0.0});
  auto field_alone = at_rest(somewhere);
  field_alone.specific_force_body_mps2.setZero();
  // A cycle of ten steps: five with the accelerometer, one with the magnetometer, four with neither.
  for (int i = 0; i < 6000; ++i) {
    if (i % 10 == 9)
      filter.update(settings, field_alone);
    else if (i % 2 == 0)
      filter.update(settings, without_field(at_rest(somewhere)));
    else
      filter.update(settings, gyroscope_alone(at_rest(somewhere)));
    CHECK_FALSE(filter.internal_states(settings).accelerometer_ignored);
  }
  CHECK(tilt_error_rad(filter, somewhere) < 1e-6);  // the accelerometer acts in half of the 60 s
  CHECK(distance_rad(filter, somewhere) / 0.05 ==   // the magnetometer in a tenth
        Approx(std::exp(-0.1 * 0.5 * 60.0)).epsilon(0.05));
}

}  // namespace ahrs_test
