/// Rejection with recovery: after the timeout a sensor is used until it agrees, without restart or jump.

#include "attitude/ahrs_support.hpp"

#include <catch2/catch.hpp>

namespace ahrs_recovery_test {

using namespace sonopose;
using namespace sonopose::testing;

const Quaterniond level = Quaterniond::Identity();
const AhrsSettings default_settings;  // the default form

/// Measurements at rest at another orientation, which contradict the estimate.
attitude::Measurement<double> elsewhere(const Vector3d& rotation_rad) {
  return at_rest(geometry::rotation_by(rotation_rad));
}

/// Returns true if `ignored` contradictions per agreement lead to recovery within 60 s.
bool recovers(int ignored) {
  AhrsSettings quick;
  quick.rejection_timeout_s = 0.5;
  Ahrs filter = settled_at(level, quick);
  for (int i = 0; i < 6000; ++i) {
    const bool agrees = i % (ignored + 1) == ignored;
    filter.update(quick, agrees ? at_rest(level) : without_field(elsewhere({30 * degree, 0, 0})));
    if (filter.flags(quick).acceleration_timeout) return true;
  }
  return false;
}

TEST_CASE("recovery is the default") {
  CHECK(default_settings.rejection == RejectionForm::recovery);
}

TEST_CASE("a contradicting accelerometer is ignored for the timeout, then followed at the final gain") {
  const auto tilted = without_field(elsewhere({30 * degree, 0, 0}));
  Ahrs filter = settled_at(level);
  run(filter, default_settings, tilted, 5.0);
  CHECK(distance_rad(filter, level) < rounding_rad);
  CHECK(filter.internal_states(default_settings).accelerometer_ignored);
  CHECK(filter.flags(default_settings).acceleration_warning);
  CHECK_FALSE(filter.flags(default_settings).acceleration_timeout);

  run(filter, default_settings, tilted, 0.1);
  CHECK(filter.flags(default_settings).acceleration_timeout);
  CHECK_FALSE(filter.internal_states(default_settings).accelerometer_ignored);
  CHECK_FALSE(filter.flags(default_settings).initialising);
  CHECK(distance_rad(filter, level) ==
        Approx(0.1 * default_settings.gain * std::sin(30 * degree)).epsilon(0.15));
}

TEST_CASE("recovery goes on until the timer is back at 0") {
  const auto tilted = without_field(elsewhere({30 * degree, 0, 0}));
  Ahrs filter = settled_at(level);
  run(filter, default_settings, tilted, 5.02);
  REQUIRE(filter.flags(default_settings).acceleration_timeout);
  // de/dt = −gain · sin(e): tan(e/2) decays exponentially and passes 10° after 2.2 s.
  const double inside_after_s =
      std::log(std::tan(15 * degree) / std::tan(5 * degree)) / default_settings.gain;
  run(filter, default_settings, tilted, inside_after_s - 0.05);
  CHECK(filter.internal_states(default_settings).acceleration_timer == 1.0);
  run(filter, default_settings, tilted, 0.1 + 5.0 / 9.0 - 0.15);
  CHECK(filter.internal_states(default_settings).acceleration_error_deg < 10.0);
  CHECK(filter.flags(default_settings).acceleration_timeout);
  run(filter, default_settings, tilted, 0.15);
  CHECK_FALSE(filter.flags(default_settings).acceleration_timeout);
  CHECK(filter.internal_states(default_settings).acceleration_timer == 0.0);
}

TEST_CASE("recovery comes when ignored updates exceed nine times the used ones") {
  CHECK_FALSE(recovers(5));
  CHECK_FALSE(recovers(9));
  CHECK(recovers(10));
  CHECK(recovers(20));
}

TEST_CASE("a contradicting magnetometer is followed after the timeout, without a jump") {
  const auto turned = elsewhere({0, 0, 100 * degree});
  Ahrs filter = settled_at(level);
  run(filter, default_settings, turned, 5.0);
  CHECK(distance_rad(filter, level) < rounding_rad);
  double yaw_rad = 0.0;
  for (int i = 0; i < 3000; ++i) {
    filter.update(default_settings, turned);
    const double now_rad = geometry::yaw_of(filter.orientation());
    CHECK(now_rad - yaw_rad <= default_settings.gain * step_s * 1.0001);
    if (i == 10) CHECK(filter.flags(default_settings).magnetic_timeout);
    CHECK_FALSE(filter.flags(default_settings).initialising);
    yaw_rad = now_rad;
  }
  CHECK(yaw_rad == Approx(100 * degree).margin(1e-4));
  CHECK_FALSE(filter.flags(default_settings).magnetic_timeout);
}

TEST_CASE("the warnings come at a quarter of the timeout") {
  for (const RejectionForm form : {RejectionForm::recovery, RejectionForm::seed}) {
    AhrsSettings chosen;
    chosen.rejection = form;
    Ahrs filter = settled_at(level, chosen);
    const auto wrong = elsewhere({60 * degree, 0, 100 * degree});
    run(filter, chosen, wrong, 1.2);
    CHECK_FALSE(filter.flags(chosen).acceleration_warning);
    CHECK_FALSE(filter.flags(chosen).magnetic_warning);
    CHECK(filter.internal_states(chosen).acceleration_timer == Approx(1.2 / 5.0));
    CHECK(filter.internal_states(chosen).magnetic_timer == Approx(1.2 / 5.0));
    run(filter, chosen, wrong, 0.1);
    CHECK(filter.flags(chosen).acceleration_warning);
    CHECK(filter.flags(chosen).magnetic_warning);
  }
}

TEST_CASE("a timeout comes after the same time at any step, a varying one too") {
  for (const RejectionForm form : {RejectionForm::recovery, RejectionForm::seed}) {
    AhrsSettings chosen;
    chosen.rejection = form;
    for (const int pattern : {0, 1, 2}) {
      Ahrs filter = settled_at(level, chosen);
      auto wrong = elsewhere({60 * degree, 0, 0});
      double passed_s = 0.0;
      for (int i = 0; !filter.flags(chosen).acceleration_timeout && passed_s < 10.0; ++i) {
        wrong.dt_s = pattern == 0 ? 0.002 : pattern == 1 ? 0.02 : (i % 2 == 0 ? 0.001 : 0.015);
        filter.update(chosen, wrong);
        passed_s += wrong.dt_s;
      }
      INFO("pattern " << pattern);
      CHECK(passed_s == Approx(5.0).margin(0.041));
    }
  }
}

}  // namespace ahrs_recovery_test
