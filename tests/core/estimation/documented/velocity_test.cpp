/// Velocity corrections (items 3, 7, 8 and 26–28).

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace velocity_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::epoch_ns;

VelocitySettings plain() {
  VelocitySettings settings;
  settings.blend_weight = 0.4;
  settings.snap_min_speed_mps = 1.0;
  return settings;
}

FixAssessment assessment_with(double weight) {
  FixAssessment assessment;
  assessment.weight = weight;
  return assessment;
}

TimedFix fix_at(double time_s, const Vector3d& position_world_m) {
  return {epoch_ns + to_ns(time_s), position_world_m, position_world_m};
}

FixAssessment outlier() {
  FixAssessment assessment;
  assessment.outlier = true;
  return assessment;
}

/// The state after one fix.
VelocityState after(const TimedFix& fix) {
  VelocityState state;
  velocity::restart(state, fix, false);
  return state;
}

/// The state in the middle of a long run.
VelocityState settled() {
  VelocityState state;
  state.velocities = VelocityState::averaged_velocities;
  return state;
}

FixVelocity between(const Vector3d& ultrasonic, const Vector3d& inertial, double bend_m = 0.0) {
  return {ultrasonic, inertial, 0.08 * ultrasonic, 0.08, bend_m};
}

/// Velocity after one fix, initially `inertial`, with these settings.
Vector3d after_fix(const VelocitySettings& settings, const Vector3d& ultrasonic, const Vector3d& inertial,
                   double weight = 1.0, double acceleration_mps2 = 0.0) {
  auto body = test::moving_body(inertial);
  body.acceleration_world_mps2 = {0, acceleration_mps2, 0};
  VelocityState run = settled();
  velocity::correct(settings, run, body, between(ultrasonic, inertial), assessment_with(weight));
  return body.velocity_world_mps;
}

std::uint32_t flags_after(const VelocitySettings& settings, const Vector3d& ultrasonic,
                          const Vector3d& inertial) {
  auto body = test::moving_body(inertial);
  VelocityState run = settled();
  return velocity::correct(settings, run, body, between(ultrasonic, inertial), assessment_with(1.0)).flags;
}

TEST_CASE("item 3: one fix moves the velocity by blend × reliability × difference") {
  const Vector3d v_us(1.2, 0.3, 0);
  const Vector3d v_imu(1.0, 0, 0.1);
  CHECK((after_fix(plain(), v_us, v_imu, 0.5) - v_imu - 0.4 * 0.5 * (v_us - v_imu)).norm() < 1e-12);
  VelocitySettings settings = plain();
  settings.blend_weight = 0.0;
  CHECK((after_fix(settings, v_us, v_imu) - v_imu).norm() < 1e-15);
  settings.blend_weight = 1.0;
  CHECK((after_fix(settings, v_us, v_imu) - v_us).norm() < 1e-12);
}

TEST_CASE("item 3: the mean over the interval is compared and not the present velocity") {
  // Acceleration of 4 m/s², fixes 0.1 s apart, the later 0.07 s old: their mean velocity is far below the
  // current one.
  Kinematics body;
  body.time_ns = epoch_ns;
  const auto x_at = [](double t) { return 0.5 * 4.0 * t * t; };  // t from 1 s ago
  for (int i = 0; i <= 100; ++i) {
    body.displacement_world_m = {x_at(0.01 * i), 0, 0};
    body.history.push({epoch_ns - to_ns(1.0 - 0.01 * i), body.displacement_world_m, 0.0});
  }
  body.velocity_world_mps = {4, 0, 0};
  VelocityState state = after(fix_at(-0.17, {x_at(0.83), 0, 0}));
  const auto measured =
      velocity::measure(plain(), state, body, fix_at(-0.07, {x_at(0.93), 0, 0}), FixAssessment{});
  REQUIRE(measured.has_value());
  CHECK(measured->ultrasonic_world_mps.x() == Approx(4.0 * 0.88));
  CHECK(measured->inertial_world_mps.x() == Approx(4.0 * 0.88));
  VelocityState run = settled();
  velocity::correct(plain(), run, body, *measured, assessment_with(1.0));
  CHECK(body.velocity_world_mps.x() == Approx(4.0));  // nothing to correct
}

TEST_CASE("a velocity requires two good fixes within the interval limits") {
  const auto body = test::moving_body({1, 0, 0});
  const VelocityState first = after(fix_at(-0.5, Vector3d::Zero()));
  VelocitySettings settings = plain();
  settings.interval_min_s = 0.05;
  settings.interval_max_s = 0.4;
  const auto measured_after = [&](double interval_s, const FixAssessment& assessment = {}) {
    VelocityState state = first;
    const auto fix = fix_at(-0.5 + interval_s, {interval_s, 0, 0});
    return velocity::measure(settings, state, body, fix, assessment).has_value();
  };
  CHECK_FALSE(measured_after(0.032));
  CHECK(measured_after(0.051));
  CHECK(measured_after(0.399));
  CHECK_FALSE(measured_after(0.401));
  CHECK_FALSE(measured_after(0.1, outlier()));

  VelocityState none;
  CHECK_FALSE(
      velocity::measure(plain(), none, body, fix_at(-0.1, Vector3d::Zero()), FixAssessment{}).has_value());
}

TEST_CASE("two fixes too close together: the older stays the reference") {
  const auto body = test::moving_body({1, 0, 0});
  VelocityState state = after(fix_at(-0.2, Vector3d::Zero()));
  CHECK_FALSE(
      velocity::measure(plain(), state, body, fix_at(-0.17, {0.9, 0, 0}), FixAssessment{}).has_value());
  const auto measured = velocity::measure(plain(), state, body, fix_at(-0.1, {0.1, 0, 0}), FixAssessment{});
  REQUIRE(measured.has_value());
  CHECK(measured->ultrasonic_world_mps.x() == Approx(1.0));
}

TEST_CASE("the velocity is measured over the wanted interval if there are earlier fixes") {
  // 11 fixes per second of a body that stands, then is pushed ever faster: 0, 3, 12 and 27 cm.
  const auto body = test::moving_body(Vector3d::Zero());
  VelocitySettings settings = plain();
  const auto speed_over = [&](double wanted_s) {
    settings.interval_wanted_s = wanted_s;
    VelocityState state = after(fix_at(-0.4, Vector3d::Zero()));
    std::optional<FixVelocity> measured;
    for (int i = 1; i <= 3; ++i) {
      measured = velocity::measure(settings, state, body, fix_at(-0.4 + 0.09 * i, {0.03 * i * i, 0, 0}),
                                   FixAssessment{});
    }
    REQUIRE(measured.has_value());
    return measured->ultrasonic_world_mps.x();
  };
  CHECK(speed_over(0.05) == Approx((0.27 - 0.12) / 0.09));
  CHECK(speed_over(0.15) == Approx((0.27 - 0.03) / 0.18));
  CHECK(speed_over(0.25) == Approx(0.27 / 0.27));
  CHECK(speed_over(9.0) == Approx(0.27 / 0.27));  // no fix is that old: the oldest that may be used
}

TEST_CASE("an outlier is no endpoint of an interval") {
  const auto body = test::moving_body({1, 0, 0});
  VelocityState state = after(fix_at(-0.3, Vector3d::Zero()));
  CHECK_FALSE(velocity::measure(plain(), state, body, fix_at(-0.2, {9, 9, 9}), outlier()).has_value());
  const auto measured = velocity::measure(plain(), state, body, fix_at(-0.1, {0.2, 0, 0}), FixAssessment{});
  REQUIRE(measured.has_value());
  CHECK(measured->ultrasonic_world_mps.x() == Approx(1.0));
}

TEST_CASE("outliers that agree with each other measure a velocity among themselves") {
  const auto body = test::moving_body({1, 0, 0});
  FixAssessment assessment = outlier();
  assessment.sigma_m = 0.1;
  VelocityState state = after(fix_at(-0.4, Vector3d::Zero()));
  assessment.rivals = 1;
  CHECK_FALSE(velocity::measure(plain(), state, body, fix_at(-0.3, {5.0, 0, 0}), assessment).has_value());
  assessment.rivals = 2;
  auto measured = velocity::measure(plain(), state, body, fix_at(-0.2, {5.11, 0, 0}), assessment);
  REQUIRE(measured.has_value());
  CHECK(measured->by_rivals);
  CHECK(measured->ultrasonic_world_mps.x() == Approx(1.1));
  CHECK(measured->agreement == Approx(trust::weight_of(0.01, 0.1)));
  AND_WHEN("a good fix follows") {
    assessment = FixAssessment{};
    measured = velocity::measure(plain(), state, body, fix_at(-0.1, {0.33, 0, 0}), assessment);
    THEN("it is compared with the good one before them") {
      REQUIRE(measured.has_value());
      CHECK_FALSE(measured->by_rivals);
      CHECK(measured->ultrasonic_world_mps.x() == Approx(1.1));
    }
  }
}

TEST_CASE("item 3: a fix that is aside by less than an outlier turns the velocity by less") {
  // Both fixes have full weight; the second is 0.2 m off the inertial path.
  FixVelocity measured = between({0, 2.5, 0}, Vector3d::Zero());
  VelocitySettings settings = plain();
  settings.undershoot_fix = false;
  const auto changed_mps = [&](double agreement) {
    auto body = test::moving_body(Vector3d::Zero());
    measured.agreement = agreement;
    VelocityState run = settled();
    velocity::correct(settings, run, body, measured, assessment_with(1.0));
    return body.velocity_world_mps.norm();
  };
  CHECK(changed_mps(1.0) == Approx(0.4 * 2.5));
  CHECK(changed_mps(trust::weight_of(0.2, 0.1)) == Approx(0.4 * 2.5 * 0.2));
}

TEST_CASE("item 7: an IMU more than twice as fast in the same direction takes the ultrasonic velocity") {
  const Vector3d slow(1.5, 0, 0);
  CHECK(flags_after(plain(), slow, {3.01, 0, 0}) == fix_snapped_over);
  CHECK((after_fix(plain(), slow, {3.01, 0, 0}) - slow).norm() < 1e-12);
  CHECK(flags_after(plain(), slow, {2.99, 0, 0}) == 0);
  CHECK(flags_after(plain(), slow, {-3.01, 0, 0}) == 0);  // opposite direction
  VelocitySettings off = plain();
  off.overshoot_fix = false;
  CHECK(flags_after(off, slow, {3.01, 0, 0}) == 0);
}

TEST_CASE("item 8: an ultrasonic velocity more than twice the IMU's is taken at once") {
  const Vector3d fast(3, 0, 0);
  CHECK(flags_after(plain(), fast, {1.49, 0, 0}) == fix_snapped_under);
  CHECK((after_fix(plain(), fast, {1.49, 0, 0}) - fast).norm() < 1e-12);
  CHECK(flags_after(plain(), fast, {1.51, 0, 0}) == 0);
  VelocitySettings off = plain();
  off.undershoot_fix = false;
  CHECK(flags_after(off, fast, {1.49, 0, 0}) == 0);
}

TEST_CASE("item 28: below the minimum ultrasonic speed neither acts") {
  CHECK(flags_after(plain(), {0.99, 0, 0}, {5, 0, 0}) == 0);
  CHECK(flags_after(plain(), {0.99, 0, 0}, Vector3d::Zero()) == 0);
  CHECK(flags_after(plain(), {1.01, 0, 0}, {5, 0, 0}) == fix_snapped_over);
  CHECK(flags_after(plain(), {1.01, 0, 0}, Vector3d::Zero()) == fix_snapped_under);
}

TEST_CASE("a stray fix, far from the extrapolation of the two before it, causes no snap") {
  VelocitySettings settings = plain();
  settings.snap_max_bend_m = 0.1;
  const auto flags_for = [&](double bend_m) {
    auto body = test::moving_body({1, 0, 0});
    const auto measured = between({3, 0, 0}, {1, 0, 0}, bend_m);
    VelocityState run = settled();
    return velocity::correct(settings, run, body, measured, assessment_with(1.0)).flags;
  };
  CHECK(flags_for(0.09) == fix_snapped_under);
  CHECK(flags_for(0.11) == 0);

  GIVEN("fixes at 1 m/s along x") {
    const auto body = test::moving_body({1, 0, 0});
    const auto bend_at = [&](const Vector3d& position_world_m) {
      VelocityState state = after(fix_at(-0.3, {0.0, 0, 0}));
      CHECK(velocity::measure(settings, state, body, fix_at(-0.2, {0.1, 0, 0}), FixAssessment{})->bend_m >
            1e9);
      return velocity::measure(settings, state, body, fix_at(-0.1, position_world_m), FixAssessment{})
          ->bend_m;
    };
    THEN("the bend is the distance from 0.2 m") {
      CHECK(bend_at({0.2, 0, 0}) == Approx(0.0).margin(1e-9));
      CHECK(bend_at({0.2, 0.3, 0.4}) == Approx(0.5));
    }
  }
}

TEST_CASE("item 3: a fix after a long pause corrects as much as several at the wanted interval") {
  VelocitySettings settings = plain();
  settings.interval_wanted_s = 0.1;
  const auto share_after = [&settings](double pause_s) {
    auto body = test::moving_body(Vector3d::Zero());
    for (int i = 0; i <= 100; ++i)
      body.history.push({epoch_ns - to_ns(1.0 - 0.01 * i), Vector3d::Zero(), 0.0});
    body.time_ns = epoch_ns;
    VelocityState state = after(fix_at(-pause_s, Vector3d::Zero()));
    state.settle();
    const auto measured =
        velocity::measure(settings, state, body, fix_at(0.0, {0.01, 0, 0}), assessment_with(1.0));
    REQUIRE(measured.has_value());
    return velocity::correct(settings, state, body, *measured, assessment_with(1.0)).share;
  };
  CHECK(share_after(0.08) == Approx(0.4));
  CHECK(share_after(0.3) == Approx(1.0 - 0.6 * 0.6 * 0.6));
}

TEST_CASE("the first velocities of a run are averaged, until item 3 counts more") {
  VelocitySettings settings = plain();
  settings.blend_weight = 0.3;
  const FixVelocity measured = between({0.5, 0, 0}, Vector3d::Zero());
  const auto share_of_next = [&](VelocityState& state) {
    auto body = test::moving_body(Vector3d::Zero());
    return velocity::correct(settings, state, body, measured, assessment_with(1.0)).share;
  };
  GIVEN("a run at a velocity that nobody knows") {
    VelocityState state = after(fix_at(-0.2, Vector3d::Zero()));
    THEN("the shares are 1, 1/2, 1/3 and then item 3") {
      CHECK(share_of_next(state) == Approx(1.0));
      CHECK(share_of_next(state) == Approx(1.0 / 2.0));
      CHECK(share_of_next(state) == Approx(1.0 / 3.0));
      CHECK(share_of_next(state) == Approx(0.3));
      for (int i = 0; i < 10; ++i) CHECK(share_of_next(state) == Approx(0.3));
      CHECK(state.settled());
    }
  }
  GIVEN("a run that begins at rest") {
    VelocityState state;
    velocity::restart(state, fix_at(-0.2, Vector3d::Zero()), true);
    THEN("item 3 applies from the start") {
      CHECK(share_of_next(state) == Approx(0.3));
    }
  }
}

TEST_CASE("items 26 and 27: the acceleration gate halves at the threshold and closes at twice") {
  VelocitySettings gated = plain();
  gated.accel_gate = true;
  gated.accel_gate_threshold_mps2 = 3.0;
  const Vector3d v_us(1.1, 0, 0);
  const Vector3d v_imu(1.0, 0, 0);
  const auto share = [&](const VelocitySettings& settings, double acceleration) {
    return (after_fix(settings, v_us, v_imu, 1.0, acceleration) - v_imu).x() / 0.1;
  };
  CHECK(share(gated, 0.0) == Approx(0.4));
  CHECK(share(gated, 1.5) == Approx(0.3));
  CHECK(share(gated, 3.0) == Approx(0.2));
  CHECK(share(gated, 6.0) == Approx(0.0).margin(1e-12));
  CHECK(share(gated, 60.0) == Approx(0.0).margin(1e-12));
  CHECK_FALSE(VelocitySettings{}.accel_gate);
  CHECK(share(plain(), 60.0) == Approx(0.4));
}

TEST_CASE("items 20–22: forced convergence corrects the velocity at its own weight") {
  auto body = test::moving_body({4, 0, 0});
  FixAssessment forced = assessment_with(0.002);
  forced.forced = true;
  forced.weight_floor = 0.5;
  VelocityState run = settled();
  velocity::correct(plain(), run, body, between(Vector3d::Zero(), {4, 0, 0}), forced);
  CHECK(body.velocity_world_mps.x() == Approx(4.0 - 0.4 * 0.5 * 4.0));
}

TEST_CASE("the second fix after a pause sets the velocity") {
  auto body = test::moving_body(Vector3d::Zero());
  VelocityState run = settled();
  const Vector3d change = velocity::initialise(run, body, between({6, 1, 0}, Vector3d::Zero()));
  CHECK((body.velocity_world_mps - Vector3d(6, 1, 0)).norm() < 1e-12);
  CHECK((change - Vector3d(6, 1, 0)).norm() < 1e-12);
}

}  // namespace velocity_test
