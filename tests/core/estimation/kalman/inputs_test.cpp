/// Rare inputs of the Kalman engine: copies, late or slow headings, slow turns, a turn before the first fix,
/// slow IMUs.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/delayed_fusion_buffer.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/preset.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace kalman_inputs_test {

using namespace sonopose;
using namespace sonopose::estimation;
using geometry::radians_per_degree;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;

ImuSample imu_at(double time_s, const Vector3d& rate_body_radps, const Vector3d& force_body_mps2) {
  ImuSample imu;
  imu.sensor_time_ns = imu.bridge_time_ns = epoch_ns + to_ns(time_s);
  imu.angular_velocity_body_radps = rate_body_radps;
  imu.specific_force_body_mps2 = force_body_mps2;
  return imu;
}

UltrasonicFix fix_at(double time_s, const Vector3d& position_world_m) {
  UltrasonicFix fix;
  fix.emission_time_ns = fix.received_time_ns = epoch_ns + to_ns(time_s);
  fix.measured_delay_s = 0.0;
  fix.position_world_m = position_world_m;
  return fix;
}

PairHeading heading_at(double time_s, double heading_rad) {
  PairHeading heading;
  heading.emission_time_ns = heading.received_time_ns = epoch_ns + to_ns(time_s);
  heading.heading_world_rad = geometry::wrap_angle(heading_rad);
  heading.valid = true;
  return heading;
}

SCENARIO("a copy of a fix or heading is used once, whatever its delay is taken from") {
  GIVEN("an engine with a fixed delay") {
    settings::Settings settings;
    settings.delay.source = settings::DelaySource::fixed;
    kalman::Engine engine{settings};
    test::poses_of(engine, sim::record(sim::find_scenario("walk"), {.seed = 5, .duration_s = 10.0}).events);
    const double now_s = seconds_between(epoch_ns, engine.time_ns());
    UltrasonicFix fix = fix_at(now_s, engine.state().filter().tracked_position_world_m());
    fix.emission_time_ns -= 70'000'000;
    REQUIRE((engine.correct(fix).flags & fix_used) != 0);
    const auto before = engine.snapshot();
    WHEN("the fix comes again 1 ms later") {
      fix.received_time_ns += 1'000'000;
      THEN("it is rejected and changes nothing") {
        CHECK(engine.correct(fix).flags == fix_invalid);
        CHECK(engine.snapshot().history == before.history);
      }
    }
    WHEN("another fix of that emission comes, with other coordinates") {
      fix.received_time_ns += 1'000'000;
      fix.position_world_m.x() += 0.02;
      THEN("it is no copy") {
        CHECK(engine.correct(fix).flags != fix_invalid);
      }
    }
  }
}

SCENARIO("a heading that comes too late is counted as invalid") {
  GIVEN("an engine in motion") {
    kalman::Engine engine{settings::Settings{}};
    test::poses_of(engine, sim::record(sim::find_scenario("walk"), {.seed = 5, .duration_s = 10.0}).events);
    const auto before = engine.counters();
    WHEN("a heading of 1.9 s ago arrives") {
      engine.correct(heading_at(seconds_between(epoch_ns, engine.time_ns()) - 1.9, 0.3));
      THEN("no heading was used, and a sample was invalid") {
        CHECK(engine.counters().samples_invalid == before.samples_invalid + 1);
        CHECK(engine.counters().headings == before.headings);
      }
    }
  }
}

SCENARIO("headings win at any rate, if they contradict the yaw for long") {
  GIVEN("a body at rest whose pair was turned while it was off, with a heading every 1.5 s") {
    kalman::Engine engine{settings::Settings{}};
    for (int k = 0; k < 4000; ++k) {
      const double time_s = 0.01 * k;
      engine.predict(imu_at(time_s, Vector3d::Zero(), {0, 0, standard_gravity_mps2}));
      if (k % 10 == 5) engine.correct(fix_at(time_s, {1.0 + 0.01 * std::sin(k), 2.0, 1.0}));
      if (k % 150 == 0) engine.correct(heading_at(time_s, time_s < 15.0 ? 0.2 : 0.9));
    }
    THEN("the yaw is that of the headings") {
      CHECK(geometry::yaw_of(engine.state().filter().q_body_to_world) == Approx(0.9).margin(0.05));
    }
  }
}

SCENARIO("the gyro turns the last heading until the first fix") {
  GIVEN("a body that turns by 2 rad/s, one heading at 0.1 s, and the first fix at 0.5 s") {
    kalman::Engine engine{settings::Settings{}};
    for (int k = 0; k <= 55; ++k) {
      const double time_s = 0.01 * k;
      engine.predict(imu_at(time_s, {0, 0, 2.0}, {0, 0, standard_gravity_mps2}));
      if (k == 10) engine.correct(heading_at(time_s, 0.5));
      if (k == 50) engine.correct(fix_at(time_s, {1, 2, 3}));
    }
    THEN("the yaw begins where the body now points") {
      CHECK(geometry::yaw_of(engine.state().filter().q_body_to_world) ==
            Approx(0.5 + 2.0 * 0.45).margin(2.0 * radians_per_degree));
    }
  }
}

SCENARIO("no heading from before a silence of the IMU starts the yaw") {
  GIVEN("a body that turns by 2 rad/s, a heading at 0.1 s, and an IMU that is silent from then until 0.4 s") {
    const double silent_until_s = GENERATE(0.0, 0.4);
    const double first_fix_s = GENERATE(0.37, 0.45);
    CAPTURE(silent_until_s, first_fix_s);
    kalman::Engine engine{settings::Settings{}};
    bool has_fix = false;
    for (int k = 0; k <= 50; ++k) {
      const double time_s = 0.01 * k;
      if (k > 10 && time_s < silent_until_s - 0.005) continue;
      if (!has_fix && time_s > first_fix_s) {
        engine.correct(fix_at(first_fix_s, {1, 2, 3}));
        has_fix = true;
      }
      engine.predict(imu_at(time_s, {0, 0, 2.0}, {0, 0, standard_gravity_mps2}));
      if (k == 10) engine.correct(heading_at(time_s, 0.5));
    }
    THEN("the yaw is unknown after the silence, and known without one") {
      const bool is_unknown = engine.state().phase == kalman::Phase::searching_yaw;
      CHECK(is_unknown == (silent_until_s > 0.0));
    }
  }
}

SCENARIO("a heading is forgotten with a filter that is not finite") {
  GIVEN("a state whose yaw became NaN after a heading") {
    const settings::Settings settings = settings::resolved(settings::Settings{});
    kalman::State state;
    const auto sample = [&](double time_s) {
      state.on_imu(settings, {.time_ns = epoch_ns + to_ns(time_s),
                              .rate_body_radps = {0, 0, 0.1},
                              .force_body_mps2 = {0, 0, standard_gravity_mps2}});
    };
    const auto fix = [&](double time_s) {
      state.on_fix(settings, {.time_ns = epoch_ns + to_ns(time_s), .position_world_m = {1, 2, 3}});
    };
    sample(0.0);
    state.on_heading(settings, {.time_ns = epoch_ns, .heading_world_rad = 0.5});
    fix(0.01);
    REQUIRE(state.phase == kalman::Phase::tracking);
    for (kalman::Hypothesis& each : state.bank)
      each.filter.q_body_to_world.coeffs().setConstant(std::nan(""));
    WHEN("two fixes follow") {
      sample(0.02);
      fix(0.03);
      CHECK(state.phase == kalman::Phase::waiting);
      sample(0.04);
      fix(0.05);
      THEN("the second one starts the estimate with an unknown, finite yaw") {
        CHECK(state.phase == kalman::Phase::searching_yaw);
        CHECK(state.filter().is_finite());
        CHECK(state.imu_fault.scatter_m2.allFinite());
        CHECK(state.frozen_track.moved_world_m.allFinite());
      }
    }
    WHEN("a heading follows") {
      sample(0.02);
      state.on_heading(settings, {.time_ns = epoch_ns + to_ns(0.02), .heading_world_rad = 0.5});
      THEN("the estimate waits for a fix that starts it again") {
        CHECK(state.phase == kalman::Phase::waiting);
        fix(0.03);
        CHECK(state.phase == kalman::Phase::searching_yaw);
        CHECK(state.filter().is_finite());
      }
    }
  }
}

SCENARIO("a slow, smooth turn is no gyro bias") {
  GIVEN("a body that drives a circle at 1 m/s and 0.05 rad/s from the first sample on") {
    const bool has_headings = GENERATE(true, false);
    CAPTURE(has_headings);
    constexpr double turn_radps = 0.05;
    constexpr double speed_mps = 1.0;
    kalman::Engine engine{settings::Settings{}};
    for (int k = 0; k < 1000; ++k) {
      const double time_s = 0.01 * k;
      const double yaw_rad = turn_radps * time_s;
      engine.predict(imu_at(time_s, {0, 0, turn_radps}, {0, speed_mps * turn_radps, standard_gravity_mps2}));
      if (k % 8 != 0) continue;
      const double radius_m = speed_mps / turn_radps;
      const Vector3d noise_m = 0.01 * Vector3d(std::sin(1.7 * k), std::cos(2.3 * k), std::sin(3.1 * k));
      engine.correct(
          fix_at(time_s, noise_m + radius_m * Vector3d(std::sin(yaw_rad), 1.0 - std::cos(yaw_rad), 0.0)));
      if (has_headings) engine.correct(heading_at(time_s, yaw_rad + 0.01 * std::sin(k)));
    }
    THEN("the bias is small") {
      CHECK(std::abs(engine.state().filter().gyro_bias_body_radps.z()) < 0.01);
    }
  }
}

SCENARIO("errors that repeat at rest do not show the noise of a body that moves") {
  GIVEN(
      "a body that rests with repeated fixes and headings, then drives; its fixes lag, and the error of its "
      "headings grows by 2°") {
    const double lag_s = GENERATE(0.06, 0.08, 0.1);
    const double heading_error_rad = geometry::radians_per_degree * GENERATE(-4.0, 0.0, 4.0);
    CAPTURE(lag_s, heading_error_rad);
    constexpr double rest_s = 30.0;
    constexpr double accel_mps2 = 3.0;
    constexpr double speed_mps = 2.5;
    const auto x_at = [&](double time_s) {
      const double driven_s = std::max(0.0, time_s - rest_s);
      const double speeding_s = std::min(driven_s, speed_mps / accel_mps2);
      return 0.5 * accel_mps2 * speeding_s * speeding_s + speed_mps * (driven_s - speeding_s);
    };
    kalman::Engine engine{settings::Settings{}};
    int rejected = 0;
    int headings_rejected = 0;
    double worst_m = 0.0;
    for (int k = 0; k < 3400; ++k) {
      const double time_s = 0.01 * k;
      const double vibration = time_s > rest_s ? 0.2 * std::sin(2.1 * k) : 0.0;
      const bool speeds_up = time_s > rest_s && time_s <= rest_s + speed_mps / accel_mps2;
      const auto pose = engine.predict(
          imu_at(time_s, {0, 0, 0}, {(speeds_up ? accel_mps2 : 0.0) + vibration, 0, standard_gravity_mps2}));
      if (pose && time_s > 2.0)
        worst_m = std::max(worst_m, std::abs(pose->position_world_m.x() - x_at(time_s)));
      if (k % 8 != 0) continue;
      const FixReport report = engine.correct(fix_at(time_s, {x_at(time_s - lag_s), 2.0, 0.5}));
      if (time_s > 2.0 && (report.flags & fix_used) == 0) ++rejected;
      const double more_rad = time_s > rest_s ? 2.0 * radians_per_degree : 0.0;
      engine.correct(heading_at(time_s, heading_error_rad + more_rad));
      headings_rejected = std::max(headings_rejected, engine.state().headings.rejected_in_row);
    }
    THEN("no fix or heading is rejected, and the pose is off by no more than the lag explains") {
      CHECK(rejected == 0);
      CHECK(headings_rejected == 0);
      CHECK(worst_m < 1.5 * lag_s * speed_mps);
    }
  }
}

SCENARIO("an engine keeps little more than a second, whatever the steps of its IMU") {
  GIVEN("an IMU whose steps are joined in groups of different sizes, and fixes") {
    const std::vector<int> steps_ms =
        GENERATE(std::vector{4, 3}, std::vector{5, 1}, std::vector{5}, std::vector{10}, std::vector{2, 1, 1});
    const int fix_interval_ms = GENERATE(5, 100);
    const bool has_headings = GENERATE(true, false);  // without headings the yaw is searched
    CAPTURE(steps_ms, fix_interval_ms, has_headings);
    kalman::Engine engine{settings::Settings{}};
    int refused = 0;
    int fix_ms = 0;
    int now_ms = 0;
    for (std::size_t k = 0; now_ms < 6000; ++k) {
      now_ms += steps_ms[k % steps_ms.size()];
      engine.predict(imu_at(1e-3 * now_ms, {0, 0, 0}, {0, 0, standard_gravity_mps2}));
      if (now_ms - fix_ms < fix_interval_ms) continue;
      fix_ms = now_ms;
      const FixReport report = engine.correct(fix_at(1e-3 * now_ms, {1.0, 2.0, 0.5}));
      if ((report.flags & (fix_too_late | fix_invalid)) != 0) ++refused;
      if (has_headings && now_ms % 3 == 0) engine.correct(heading_at(1e-3 * now_ms, 0.0));
    }
    THEN("no fix is refused, and the oldest sample is at most 1.5 s old") {
      CHECK(refused == 0);
      const kalman::History history = engine.snapshot().history;
      CHECK(seconds_between(history.imu.front().time_ns, engine.time_ns()) < 1.5);
    }
  }
}

TEST_CASE("an engine reserves less than 2 MB") {
  constexpr std::size_t bytes =
      (kalman::Checkpoints::capacity + 1) *
          (sizeof(kalman::State) + kalman::HypothesisBank::capacity * sizeof(kalman::Hypothesis)) +
      kalman::imu_capacity * sizeof(kalman::ImuMeasurement) +
      kalman::aiding_capacity * sizeof(kalman::AidingMeasurement);
  STATIC_REQUIRE(bytes < 2'000'000);
}

}  // namespace kalman_inputs_test
