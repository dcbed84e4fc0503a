/// A start with what an earlier run has learned of the sensors.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/aiding/known_sensors.hpp>
#include <sonopose/estimation/any_estimator.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

namespace known_sensors_test {

using namespace sonopose;
using namespace sonopose::estimation;
using aiding::known_after;
using aiding::KnownSensors;

constexpr double hour_s = 3600.0;
constexpr double restart_s = 50.0;

Estimate learned_estimate() {
  Estimate estimate;
  estimate.gyro_bias_body_radps =
      VectorEstimate{.value = {0.01, -0.02, 0.005}, .std = Vector3d::Constant(0.001)};
  estimate.accelerometer_bias_body_mps2 =
      VectorEstimate{.value = {0.05, 0.02, -0.1}, .std = Vector3d::Constant(0.02)};
  estimate.lever_arm_body_m = VectorEstimate{.value = {0.01, 0, 0.03}, .std = Vector3d::Constant(0.005)};
  estimate.fix_noise_m = ScalarEstimate{.value = 0.02, .std = -1.0};
  return estimate;
}

/// A walk, cut in two by a restart.
struct Walk {
  explicit Walk(std::uint64_t seed)
      : before(sim::record(sim::find_scenario("walk"), {.seed = seed, .duration_s = restart_s + 40.0})),
        after(before) {
    const TimeNs restart_ns = before.truth.front().time_ns + to_ns(restart_s);
    std::erase_if(before.events, [&](const Event& event) { return available_at_ns(event) >= restart_ns; });
    std::erase_if(after.events, [&](const Event& event) { return available_at_ns(event) < restart_ns; });
    std::erase_if(after.truth, [&](const TruthSample& truth) { return truth.time_ns < restart_ns; });
  }

  sim::Recording before;
  sim::Recording after;
};

/// Estimate at the end of these events.
Estimate estimate_after(const std::vector<Event>& events) {
  AnyEstimator estimator{settings::Settings{}};
  for (const Event& event : events) process(estimator, event);
  estimator.finish_pending_work();
  return estimator.estimate();
}

struct Start {
  double unconverged_s = std::numeric_limits<double>::infinity();  ///< from the first pose on
  double rms_m = 0;                                                ///< error of the positions after 6 s
};

Start start_of(const sim::Recording& log, const std::optional<KnownSensors>& known) {
  AnyEstimator estimator{settings::Settings{}};
  if (known) estimator.start_from(*known);
  Start start;
  double sum_m2 = 0;
  int count = 0;
  TimeNs first_ns = 0;
  auto truth = log.truth.begin();
  for (const Event& event : log.events) {
    const auto result = process(estimator, event);
    const auto* const pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr || (pose->status & status_initialising) != 0) continue;
    if (first_ns == 0) first_ns = pose->time_ns;
    const double since_s = seconds_between(first_ns, pose->time_ns);
    if ((pose->status & (status_uncalibrated | status_converging)) == 0) {
      start.unconverged_s = std::min(start.unconverged_s, since_s);
    }
    while (truth != log.truth.end() && truth->time_ns < pose->time_ns) ++truth;
    if (since_s < 6.0 || truth == log.truth.end() || truth->time_ns != pose->time_ns) continue;
    sum_m2 += (pose->position_world_m - truth->position_world_m).squaredNorm();
    ++count;
  }
  start.rms_m = std::sqrt(sum_m2 / std::max(count, 1));
  return start;
}

SCENARIO("a start with what the last run has learned converges in a fifth of the time") {
  const std::uint64_t seed = GENERATE(8101U, 8102U, 8103U, 8104U);
  GIVEN("a walk with a restart, seed " << seed) {
    const Walk walk(seed);
    const Estimate learned = estimate_after(walk.before.events);
    REQUIRE(aiding::is_learned(learned));
    const Start unknown = start_of(walk.after, std::nullopt);
    THEN("this holds after ten seconds, and the position is no worse after an hour") {
      const Start soon = start_of(walk.after, known_after(learned, 10.0));
      CHECK(soon.unconverged_s <= 0.2 * unknown.unconverged_s);
      CHECK(start_of(walk.after, known_after(learned, hour_s)).rms_m < 1.05 * unknown.rms_m);
    }
  }
}

SCENARIO("a start with wrong knowledge recovers") {
  const std::uint64_t seed = GENERATE(8201U, 8202U, 8203U);
  GIVEN("a walk with a restart, and a gyro whose bias has moved by 1.7°/s meanwhile, seed " << seed) {
    const Walk walk(seed);
    KnownSensors known = *known_after(estimate_after(walk.before.events), hour_s);
    known.gyro_bias_body_radps.value += Vector3d(0.03, -0.03, 0.03);
    THEN("after 6 s the position is as good as without any knowledge") {
      CHECK(start_of(walk.after, known).rms_m < 1.2 * start_of(walk.after, std::nullopt).rms_m);
    }
  }
}

SCENARIO("an estimate says less with its age") {
  GIVEN("a good estimate") {
    const Estimate learned = learned_estimate();
    const auto gyro_std_radps = [&](double age_s) {
      return known_after(learned, age_s)->gyro_bias_body_radps.std.maxCoeff();
    };
    THEN("its deviations grow for an hour, and never shrink") {
      CHECK(gyro_std_radps(0.0) >= 0.001);
      CHECK(gyro_std_radps(hour_s) > 2.0 * gyro_std_radps(0.0));
      CHECK(gyro_std_radps(24.0 * hour_s) == gyro_std_radps(hour_s));
    }
    THEN("a clock that was set back makes it as uncertain as an hour does") {
      CHECK(gyro_std_radps(-1e9) == gyro_std_radps(hour_s));
    }
    THEN("it says nothing after a month") {
      CHECK(!known_after(learned, 31.0 * 24.0 * hour_s));
    }
  }
}

SCENARIO("only a good estimate is learned") {
  Estimate estimate = learned_estimate();
  REQUIRE(aiding::is_learned(estimate));
  GIVEN("one whose gyro bias is uncertain") {
    estimate.gyro_bias_body_radps->std.z() = 0.02;
    THEN("it is not learned") {
      CHECK(!aiding::is_learned(estimate));
    }
  }
  GIVEN("one with a bias that no sensor has") {
    estimate.gyro_bias_body_radps->value.x() = std::numeric_limits<double>::quiet_NaN();
    THEN("it is not learned") {
      CHECK(!known_after(estimate, 0.0));
    }
  }
  GIVEN("one of an engine that does not estimate the lever arm") {
    estimate.lever_arm_body_m.reset();
    THEN("it is not learned") {
      CHECK(!aiding::is_learned(estimate));
    }
  }
}

}  // namespace known_sensors_test
