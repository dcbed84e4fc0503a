/// Rejection as in the AHRS document: thresholds, the ten-times rule and the effect of a timeout.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

namespace ahrs_seed_rejection_test {

using namespace sonopose;
using namespace sonopose::testing;

const Quaterniond level = Quaterniond::Identity();

AhrsSettings seed_form() {
  AhrsSettings settings;
  settings.rejection = RejectionForm::seed;
  return settings;
}

/// A tilted body's specific force with a level body's magnetic field.
attitude::Measurement<double> tilted_force(double angle_rad) {
  auto m = at_rest(level);
  m.specific_force_body_mps2 =
      geometry::rotation_by({angle_rad, 0, 0}).conjugate() * m.specific_force_body_mps2;
  return m;
}

attitude::Measurement<double> turned_field(double angle_rad) {
  auto m = at_rest(level);
  m.magnetic_field_body_t = geometry::rotation_about_z(-angle_rad) * m.magnetic_field_body_t;
  return m;
}

/// States of a settled filter after one update.
attitude::AhrsInternalStates<double> states_after(const AhrsSettings& settings,
                                                  const attitude::Measurement<double>& m) {
  Ahrs filter = settled_at(level, settings);
  filter.update(settings, m);
  return filter.internal_states(settings);
}

/// Returns true if `ignored` contradictions per agreement lead to a timeout within 60 s.
bool times_out(int ignored) {
  AhrsSettings settings = seed_form();
  settings.rejection_timeout_s = 0.5;
  Ahrs filter = settled_at(level, settings);
  for (int i = 0; i < 6000; ++i) {
    const bool agrees = i % (ignored + 1) == ignored;
    filter.update(settings, agrees ? at_rest(level) : tilted_force(30 * degree));
    if (filter.flags(settings).acceleration_timeout) return true;
  }
  return false;
}

TEST_CASE("a sensor is ignored beyond its threshold, in both forms, up to 180 degrees") {
  for (const RejectionForm form : {RejectionForm::seed, RejectionForm::recovery}) {
    AhrsSettings settings;
    settings.rejection = form;
    for (const double threshold_deg : {0.5, 10.0, 20.0, 80.0, 100.0, 150.0}) {
      settings.acceleration_rejection_deg = threshold_deg;
      settings.magnetic_rejection_deg = threshold_deg;
      for (const double error_deg :
           {0.45, 0.55, 9.9, 10.1, 19.9, 20.1, 79.9, 80.1, 99.9, 100.1, 149.9, 150.1, 170.0, 179.9}) {
        INFO("threshold " << threshold_deg << " error " << error_deg);
        const auto tilt = states_after(settings, tilted_force(error_deg * degree));
        CHECK(tilt.acceleration_error_deg == Approx(error_deg));
        CHECK(tilt.accelerometer_ignored == (error_deg > threshold_deg));
        CHECK_FALSE(tilt.magnetometer_ignored);
        const auto turn = states_after(settings, turned_field(error_deg * degree));
        CHECK(turn.magnetic_error_deg == Approx(error_deg));
        CHECK(turn.magnetometer_ignored == (error_deg > threshold_deg));
        CHECK_FALSE(turn.accelerometer_ignored);
      }
    }
  }
}

TEST_CASE("an ignored sensor does not act") {
  Ahrs filter = settled_at(level, seed_form());
  run(filter, seed_form(), tilted_force(30 * degree), 4.9);
  CHECK(distance_rad(filter, level) < rounding_rad);
  run(filter, seed_form(), at_rest(level), 5.0);
  run(filter, seed_form(), turned_field(30 * degree), 4.9);
  CHECK(distance_rad(filter, level) < rounding_rad);
}

TEST_CASE("a threshold or a timeout of 0 rejects nothing") {
  for (const RejectionForm form : {RejectionForm::seed, RejectionForm::recovery}) {
    AhrsSettings settings;
    settings.rejection = form;
    settings.acceleration_rejection_deg = 0.0;
    CHECK_FALSE(states_after(settings, tilted_force(170 * degree)).accelerometer_ignored);
    CHECK(states_after(settings, turned_field(170 * degree)).magnetometer_ignored);
    settings = AhrsSettings{};
    settings.rejection = form;
    settings.magnetic_rejection_deg = 0.0;
    CHECK(states_after(settings, tilted_force(170 * degree)).accelerometer_ignored);
    CHECK_FALSE(states_after(settings, turned_field(170 * degree)).magnetometer_ignored);
    settings = AhrsSettings{};
    settings.rejection = form;
    settings.rejection_timeout_s = 0.0;
    CHECK_FALSE(states_after(settings, tilted_force(170 * degree)).accelerometer_ignored);
    CHECK_FALSE(states_after(settings, turned_field(170 * degree)).magnetometer_ignored);
  }
}

TEST_CASE("nothing is rejected while initialising") {
  Ahrs filter;
  filter.update({}, tilted_force(90 * degree));
  CHECK_FALSE(filter.internal_states({}).accelerometer_ignored);
  filter.reset(level);
  filter.update({}, turned_field(90 * degree));
  CHECK_FALSE(filter.internal_states({}).magnetometer_ignored);
}

TEST_CASE("a timeout comes when ignored updates exceed ten times the used ones") {
  CHECK_FALSE(times_out(5));
  CHECK_FALSE(times_out(10));
  CHECK(times_out(11));
  CHECK(times_out(20));
}

TEST_CASE("an acceleration timeout begins the initialisation again at the same orientation") {
  const AhrsSettings settings = seed_form();
  Ahrs filter = settled_at(level, settings);
  run(filter, settings, tilted_force(30 * degree), 5.0);
  CHECK_FALSE(filter.flags(settings).initialising);
  CHECK(filter.flags(settings).acceleration_warning);
  CHECK(filter.internal_states(settings).acceleration_timer == Approx(1.0));
  CHECK(distance_rad(filter, level) < rounding_rad);
  run(filter, settings, tilted_force(30 * degree), 0.02);
  CHECK(filter.flags(settings).initialising);
  CHECK(filter.flags(settings).acceleration_timeout);
  CHECK(filter.internal_states(settings).acceleration_timer == 0.0);
  // At most two steps at the initial gain of 10, from the old orientation.
  CHECK(distance_rad(filter, level) < 0.02 * 10.0 * std::sin(30 * degree));
  run(filter, settings, tilted_force(30 * degree), 2.9);
  CHECK(filter.flags(settings).acceleration_timeout);
  CHECK(filter.internal_states(settings).acceleration_error_deg < 0.1);
  run(filter, settings, tilted_force(30 * degree), 0.2);
  CHECK_FALSE(filter.flags(settings).acceleration_timeout);
  CHECK_FALSE(filter.flags(settings).initialising);
}

TEST_CASE("a magnetic timeout sets the heading at once and does not initialise") {
  const AhrsSettings settings = seed_form();
  Ahrs filter = settled_at(level, settings);
  run(filter, settings, turned_field(100 * degree), 5.0);
  CHECK(geometry::yaw_of(filter.orientation()) == Approx(0.0).margin(1e-9));
  CHECK(filter.flags(settings).magnetic_warning);
  CHECK_FALSE(filter.flags(settings).magnetic_timeout);
  int timeouts = 0;
  double yaw_at_timeout_rad = 0.0;
  for (int i = 0; i < 100; ++i) {
    filter.update(settings, turned_field(100 * degree));
    if (!filter.flags(settings).magnetic_timeout) continue;
    ++timeouts;
    yaw_at_timeout_rad = geometry::yaw_of(filter.orientation());
    CHECK(i < 3);
    CHECK(filter.internal_states(settings).magnetic_timer == 0.0);
  }
  CHECK(timeouts == 1);  // set for one update only
  CHECK(yaw_at_timeout_rad == Approx(100 * degree));
  CHECK(tilt_error_rad(filter, level) < rounding_rad);
  CHECK_FALSE(filter.flags(settings).initialising);
}

}  // namespace ahrs_seed_rejection_test
