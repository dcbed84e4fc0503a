/// Drift correction (items 2, 4 and 9) against an independently integrated second-order response.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace drift_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

DriftSettings settings_with(double decay_hz, double alpha, double smooth_hz) {
  DriftSettings settings;
  settings.decay_rate_hz = decay_hz;
  settings.jump_alpha = alpha;
  settings.velocity_smooth_rate_hz = smooth_hz;
  return settings;
}

TimedFix fix_at(const Vector3d& position_world_m) {
  return {0, position_world_m, position_world_m};
}

FixAssessment assessment_with(double weight) {
  FixAssessment assessment;
  assessment.weight = weight;
  return assessment;
}

/// Solves d' = −u, u' = smooth (decay·d − u) from d = 1, u = 0 with steps of a microsecond.
double second_order(double decay_hz, double smooth_hz, double seconds) {
  constexpr double dt = 1e-6;
  double d = 1.0;
  double u = 0.0;
  for (double t = 0.0; t < seconds - 0.5 * dt; t += dt) {
    const double d_next = d - dt * u;
    u += dt * smooth_hz * (decay_hz * d - u);
    d = d_next;
  }
  return d;
}

/// Remaining offset after `seconds` at `rate_hz` steps, initially 1 m.
double left_of_one_metre(const DriftSettings& settings, double weight, double seconds, double rate_hz) {
  DriftState state;
  Kinematics body;
  drift::correct(settings, state, body, fix_at(Vector3d::UnitX()), assessment_with(weight));
  const auto steps = static_cast<int>(std::lround(seconds * rate_hz));
  for (int i = 0; i < steps; ++i) drift::apply_decay(settings, state, body, 1.0 / rate_hz);
  // Position and remaining offset add up to the initial offset.
  REQUIRE(body.position_world_m.x() + state.offset_world_m.x() == Approx(1.0).margin(1e-12));
  return state.offset_world_m.x();
}

TEST_CASE("item 4: the step at the fix is alpha × weight × discrepancy, the rest waits") {
  DriftState state;
  Kinematics body;
  body.position_world_m = {1, 1, 1};
  const Vector3d jump =
      drift::correct(settings_with(3, 0.4, 15), state, body, fix_at({2, 3, 1}), assessment_with(0.5));
  CHECK((jump - 0.4 * 0.5 * Vector3d(1, 2, 0)).norm() < 1e-15);
  CHECK((body.position_world_m - Vector3d(1, 1, 1) - jump).norm() < 1e-15);
  CHECK((state.offset_world_m - 0.8 * Vector3d(1, 2, 0)).norm() < 1e-15);
}

TEST_CASE("item 2: a new fix replaces the offset, offsets never add up") {
  DriftState state;
  Kinematics body;
  const auto settings = settings_with(3, 0.0, 15);
  for (int i = 0; i < 5; ++i)
    drift::correct(settings, state, body, fix_at({0.2, 0, 0}), assessment_with(1.0));
  CHECK(state.offset_world_m.x() == Approx(0.2));
}

TEST_CASE("items 2 and 9: the offset follows the second-order response") {
  for (const auto& [decay_hz, smooth_hz] : {std::pair{1.0, 30.0}, {3.0, 15.0}, {5.0, 30.0}, {10.0, 10.0}}) {
    for (const double seconds : {0.1, 0.3, 1.0}) {
      INFO("decay " << decay_hz << " smooth " << smooth_hz << " after " << seconds << " s");
      const double expected = second_order(decay_hz, smooth_hz, seconds);
      const auto settings = settings_with(decay_hz, 0.0, smooth_hz);
      CHECK(left_of_one_metre(settings, 1.0, seconds, 100.0) == Approx(expected).margin(0.03));
      CHECK(left_of_one_metre(settings, 1.0, seconds, 1000.0) == Approx(expected).margin(0.003));
    }
  }
}

TEST_CASE("item 2: for small rates the decay is near exp(−rate·t)") {
  const auto settings = settings_with(1.0, 0.0, 30.0);
  for (const double seconds : {0.5, 1.0, 2.0, 3.0}) {
    CHECK(left_of_one_metre(settings, 1.0, seconds, 100.0) == Approx(std::exp(-seconds)).margin(0.04));
  }
}

TEST_CASE("item 2: a weight of one half halves the rate") {
  const auto full = settings_with(2.0, 0.0, 30.0);
  const auto half = settings_with(1.0, 0.0, 30.0);
  CHECK(left_of_one_metre(full, 0.5, 1.0, 100.0) == Approx(left_of_one_metre(half, 1.0, 1.0, 100.0)));
}

TEST_CASE("item 9: the drift velocity approaches its target with the time constant 1/rate") {
  for (const double rate_hz : {5.0, 15.0, 30.0}) {
    // So slow a decay of so large an offset demands a constant velocity of 1 m/s.
    const auto settings = settings_with(1e-6, 0.0, rate_hz);
    DriftState state;
    Kinematics body;
    drift::correct(settings, state, body, fix_at({1e6, 0, 0}), assessment_with(1.0));
    const auto steps = static_cast<int>(std::lround(1000.0 / rate_hz));
    for (int i = 0; i < steps; ++i) drift::apply_decay(settings, state, body, 0.001);
    CHECK(state.velocity_world_mps.x() == Approx(1.0 - std::exp(-1.0)).epsilon(0.01));
  }
}

TEST_CASE("items 2 and 9: it rings if item 2 exceeds a quarter of item 9") {
  const auto overshoots = [](double decay_hz, double smooth_hz) {
    const auto settings = settings_with(decay_hz, 0.0, smooth_hz);
    double least = 1.0;
    for (double seconds = 0.0; seconds < 3.0; seconds += 0.05) {
      least = std::min(least, left_of_one_metre(settings, 1.0, seconds, 1000.0));
    }
    return least < -1e-4;
  };
  CHECK_FALSE(overshoots(3.0, 15.0));
  CHECK(overshoots(10.0, 15.0));
}

TEST_CASE("the decay is stable at slow IMU rates and at the limits of the ranges") {
  for (const double rate_hz : {10.0, 100.0}) {
    for (const double decay_hz : {0.0, 50.0}) {
      for (const double smooth_hz : {0.1, 200.0}) {
        const double left = left_of_one_metre(settings_with(decay_hz, 0.0, smooth_hz), 1.0, 5.0, rate_hz);
        INFO("rate " << rate_hz << " decay " << decay_hz << " smooth " << smooth_hz);
        CHECK(std::abs(left) <= 1.0);
      }
    }
  }
}

TEST_CASE("items 21 and 22: the floors of a forced convergence apply at any weight") {
  DriftState state;
  Kinematics body;
  FixAssessment assessment = assessment_with(0.01);
  assessment.jump_floor = 0.6;
  assessment.weight_floor = 0.5;
  drift::correct(settings_with(3, 0.35, 15), state, body, fix_at({10, 0, 0}), assessment);
  CHECK(body.position_world_m.x() == Approx(6.0));
  CHECK(state.weight == Approx(0.5));
}

TEST_CASE("item 2, in the engine: at rest a small step of the fixes is followed as the response says") {
  Settings settings;
  settings.preset.imu_weight = ImuWeight::user;
  settings.drift = settings_with(1.0, 0.0, 30.0);
  settings.velocity.blend_weight = 0.0;
  test::EngineDriver driver(settings, test::at_rest());
  driver.run(3.0);
  driver.alter_fix = [](UltrasonicFix& fix, double) { fix.position_world_m.x() += 0.01; };
  // The first shifted fix is emitted within one interval and received one delay later.
  const std::size_t before = driver.reports.size();
  while (driver.reports.size() == before || driver.reports.back().position_world_m.x() == 0.0)
    driver.run(0.01);
  driver.run(1.0);
  const double left = 1.0 - driver.moments.back().pose.position_world_m.x() / 0.01;
  // A small step has a weight of nearly 1: 1 / (1 + (0.01/0.12)²).
  CHECK(left == Approx(second_order(1.0, 30.0, 1.0)).margin(0.02));
}

}  // namespace drift_test
