/// Uncertainty beyond that of the best filter: what else may be true.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <variant>

namespace kalman_spread_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

/// Standard deviations and status while the fixes of a walk jump by 1 m at 15 s, and stay.
struct AfterJump {
  double behind_m = 1;        ///< last distance from the truth, which has jumped, in its direction
  double towards_m = 0;       ///< mean deviation in the direction of the jump, from 0.5 to 7 s after it
  double aside_m = 0;         ///< mean deviation at right angles to it
  double later_m = 0;         ///< largest deviation in its direction, from 9 s after it on
  bool is_converging = true;  ///< true if every status said so from 0.5 to 7 s after it
  bool is_converging_later = false;
};

AfterJump jump_of_fixes(std::uint64_t seed) {
  sim::Scenario scenario = sim::find_scenario("walk");
  scenario.disturbances.relocations = {{.at_s = 15.0, .by_world_m = {0.0, 1.0, 0.0}}};
  sim::Simulator simulator(scenario, {.seed = seed, .duration_s = 32.0});
  Engine engine{settings::Settings{}};
  AfterJump after;
  TimeNs jump_ns = 0;
  int poses = 0;
  while (const auto step = simulator.next()) {
    const auto result = estimation::process(engine, step->event);
    const auto* const report = std::get_if<FixReport>(&result);
    if (report != nullptr && jump_ns == 0 && (report->flags & fix_stuck_forced) != 0)
      jump_ns = report->emission_time_ns;
    const auto* const pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr || jump_ns == 0) continue;
    if (step->truth) after.behind_m = step->truth->position_world_m.y() - pose->position_world_m.y();
    const double since_s = seconds_between(jump_ns, pose->time_ns);
    const bool is_converging = (pose->status & status_converging) != 0;
    if (since_s > 0.5 && since_s < 7.0) {
      ++poses;
      after.towards_m += pose->pose_covariance.std_dev(1);
      after.aside_m += pose->pose_covariance.std_dev(0);
      after.is_converging = after.is_converging && is_converging;
    } else if (since_s > 9.0) {
      after.later_m = std::max(after.later_m, pose->pose_covariance.std_dev(1));
      after.is_converging_later = after.is_converging_later || is_converging;
    }
  }
  REQUIRE(poses > 0);
  after.towards_m /= poses;
  after.aside_m /= poses;
  return after;
}

SCENARIO("the track that the fixes left stays possible for 8 s") {
  const std::uint64_t seed = GENERATE(11U, 12U, 13U);
  CAPTURE(seed);
  GIVEN("a walk whose fixes jump by 1 m to the side, and stay") {
    const AfterJump after = jump_of_fixes(seed);
    THEN("the covariance covers the way back, in its direction alone, and the status says so") {
      CHECK(std::abs(after.behind_m) < 0.2);
      CHECK(5.0 * after.towards_m > 1.0);
      CHECK(after.towards_m < 0.5);
      CHECK(after.aside_m < 0.2);
      CHECK(after.is_converging);
      AND_THEN("both end") {
        CHECK(after.later_m < 0.1);
        CHECK_FALSE(after.is_converging_later);
      }
    }
  }
}

/// A state that tracks, with one hypothesis per trusting model, all of them equal.
State tracking() {
  State state;
  state.phase = Phase::tracking;
  Hypothesis first;
  first.filter.covariance.diagonal().setConstant(1e-6);
  state.bank.spawn(first);
  state.bank.follow(first.filter);
  return state;
}

SCENARIO("a track that a distrusted IMU led away is not possible") {
  GIVEN("a former track 2 m away") {
    State state = tracking();
    Hypothesis& former = state.bank.spawn(state.bank.best());
    former.track = Track::former;
    former.filter.position_world_m.x() += 2.0;
    former.explained_ns = 2'000'000'000;
    WHEN("the fixes went to another one before") {
      former.began_ns = 1'000'000'000;
      THEN("the body may be there with a tenth of the weight") {
        REQUIRE(state.is_ambiguous());
        CHECK(state.spread().position_m2(0, 0) == Approx(0.1 / 1.1 * 4.0));
      }
    }
    WHEN("its IMU was distrusted at its end") {
      former.began_ns = former.explained_ns;
      THEN("nothing is ambiguous") {
        CHECK_FALSE(state.is_ambiguous());
      }
    }
  }
}

SCENARIO("a yaw on which a rough gyroscope and a quiet one disagree is uncertain") {
  constexpr double apart_rad = 4.0 * geometry::radians_per_degree;
  GIVEN("a gyroscope that is rough by the fixes, and 4 degrees to the quiet one") {
    State state = tracking();
    state.bank.best_index = state.bank.index_of(*state.bank.find(ImuModel::rough_gyro));
    Filter& quiet = state.bank.find(ImuModel::quiet)->filter;
    quiet.q_body_to_world = geometry::rotation_about_z(apart_rad) * quiet.q_body_to_world;
    WHEN("its samples are smooth, so that nothing but the fixes says so") {
      THEN("either may be right, and both may err alike") {
        REQUIRE(state.is_ambiguous());
        CHECK(std::sqrt(state.spread().yaw_rad2) == Approx(3.0 * apart_rad).epsilon(0.01));
      }
    }
    WHEN("its samples are as rough") {
      state.imu.turn_shocks.roughness = 1e3;
      THEN("it is the noise of the gyroscope, which the best filter knows") {
        CHECK(state.spread().yaw_rad2 < 1e-6);
      }
    }
  }
}

}  // namespace kalman_spread_test
