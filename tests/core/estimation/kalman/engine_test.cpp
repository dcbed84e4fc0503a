/// Accuracy of the Kalman engine on simulated runs.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>
#include <vector>

namespace kalman_engine_test {

using namespace sonopose;
using namespace sonopose::estimation;
using test::poses_of;

sim::Recording record(const char* scenario, double duration_s, std::uint64_t seed = 5) {
  return sim::record(sim::find_scenario(scenario), {.seed = seed, .duration_s = duration_s});
}

/// RMS position error of the poses after `from_s`.
double rms_m(const std::vector<FusedPose>& poses, const std::vector<TruthSample>& truth, double from_s) {
  double squares = 0.0;
  int count = 0;
  auto next = truth.begin();
  for (const FusedPose& pose : poses) {
    while (next != truth.end() && next->time_ns < pose.time_ns) ++next;
    if (next == truth.end() || next->time_ns != pose.time_ns) continue;
    if (seconds_between(truth.front().time_ns, pose.time_ns) < from_s) continue;
    squares += (pose.position_world_m - next->position_world_m).squaredNorm();
    ++count;
  }
  REQUIRE(count > 100);
  return std::sqrt(squares / count);
}

SCENARIO("the Kalman engine follows a walk within the noise of one fix") {
  GIVEN("fixes with 2 cm of noise per axis") {
    const sim::Recording walk = record("walk", 30.0);
    WHEN("all sensors work") {
      kalman::Engine engine{settings::Settings{}};
      THEN("the position is better than a fix") {
        CHECK(rms_m(poses_of(engine, walk.events), walk.truth, 6.0) < 0.02);
      }
    }
    WHEN("no heading ever comes") {
      std::vector<Event> events;
      std::copy_if(walk.events.begin(), walk.events.end(), std::back_inserter(events),
                   [](const Event& event) { return !std::holds_alternative<PairHeading>(event); });
      kalman::Engine engine{settings::Settings{}};
      const auto poses = poses_of(engine, events);
      THEN("the motion alone shows the yaw") {
        CHECK(rms_m(poses, walk.truth, 15.0) < 0.025);
        CHECK((poses.back().status & status_heading_unknown) == 0);
        CHECK(std::sqrt(engine.state().filter().yaw_variance_rad2()) < 0.05);
      }
      THEN("it is unknown at first, and known only with a standard deviation below 5 degrees") {
        CHECK((poses.front().status & status_heading_unknown) != 0);
        for (const FusedPose& pose : poses) {
          if ((pose.status & status_heading_unknown) != 0) continue;
          REQUIRE(yaw_std_rad(pose) < 5.0 * geometry::radians_per_degree);
        }
      }
    }
  }
  GIVEN("wrong tracks of up to two seconds") {
    const sim::Recording bursts = record("outlier_bursts", 60.0);
    kalman::Engine engine{settings::Settings{}};
    THEN("they do not move the pose by more than the IMU's own drift") {
      CHECK(rms_m(poses_of(engine, bursts.events), bursts.truth, 6.0) < 0.03);
    }
  }
  GIVEN("a body that is carried 2.5 m away") {
    const sim::Recording moved = record("relocation", 40.0);
    kalman::Engine engine{settings::Settings{}};
    THEN("the pose is there within two seconds") {
      CHECK(rms_m(poses_of(engine, moved.events), moved.truth, 27.0) < 0.03);
    }
  }
}

SCENARIO(
    "the pose of a sample is that of the filter after it, and its covariance that of the filter before") {
  GIVEN("a walk") {
    const sim::Recording walk = record("walk", 20.0);
    kalman::Engine engine{settings::Settings{}};
    double max_apart_m = 0.0;
    int poses = 0;
    int without_covariance = 0;
    int other_covariance = 0;
    for (const Event& event : walk.events) {
      const bool started = engine.state().phase != kalman::Phase::waiting;
      const kalman::Filter before = started ? engine.state().filter() : kalman::Filter{};
      const bool is_ambiguous = engine.state().is_ambiguous();
      const EventResult output = process(engine, event);
      engine.finish_pending_work();
      const auto* pose = std::get_if<FusedPose>(&output);
      if (pose == nullptr || !started) continue;
      if (seconds_between(walk.truth.front().time_ns, pose->time_ns) < 6.0) continue;  // it stands at first
      ++poses;
      const Vector3d after_world_m = engine.state().filter().tracked_position_world_m();
      max_apart_m = std::max(max_apart_m, (after_world_m - pose->position_world_m).norm());
      if (!(yaw_std_rad(*pose) > 0.0 && position_std_m(*pose).minCoeff() > 0.0)) ++without_covariance;
      const Covariance<6> of_filter = before.pose_covariance();
      const bool is_of_filter =
          is_ambiguous ? pose->pose_covariance.std_dev(0) >= of_filter.std_dev(0)  // and a spread
                       : pose->pose_covariance == of_filter;
      if (!is_of_filter) ++other_covariance;
    }
    THEN("while the body walks, the position is that of the filter") {
      CHECK(poses > 1300);
      CHECK(max_apart_m < 0.001);
    }
    THEN("every pose after the first fix has a covariance, of one sample before") {
      CHECK(without_covariance == 0);
      CHECK(other_covariance == 0);
    }
  }
}

SCENARIO("the Kalman engine starts with any noise of the fixes") {
  GIVEN("a walk with three fixes per second and a noise of 1, 5 or 10 cm") {
    const double noise_m = GENERATE(0.01, 0.05, 0.1);
    const std::uint64_t seed = GENERATE(range(81U, 91U));
    CAPTURE(noise_m, seed);
    sim::Scenario walk = sim::find_scenario("walk");
    walk.sensors.fix_rate_hz = {3.0, 3.0};
    walk.sensors.fix_noise_m = {noise_m, noise_m};
    const sim::Recording noisy = sim::record(walk, {.seed = seed, .duration_s = 30.0});
    kalman::Engine engine{settings::Settings{}};
    THEN("the position is soon better than a fix on all three axes") {
      CHECK(rms_m(poses_of(engine, noisy.events), noisy.truth, 6.0) < std::max(0.03, 1.7 * noise_m));
    }
  }
}

SCENARIO("the Kalman engine is better than a fix at any usual rate of the IMU") {
  GIVEN("a walk with an IMU of 50 Hz to 1 kHz") {
    const double imu_rate_hz = GENERATE(50.0, 200.0, 1000.0);
    const std::uint64_t seed = GENERATE(range(101U, 104U));
    CAPTURE(imu_rate_hz, seed);
    sim::Scenario walk = sim::find_scenario("walk");
    walk.sensors.imu_rate_hz = imu_rate_hz;
    const sim::Recording run = sim::record(walk, {.seed = seed, .duration_s = 30.0});
    kalman::Engine engine{settings::Settings{}};
    THEN("the position is better than a fix") {
      CHECK(rms_m(poses_of(engine, run.events), run.truth, 6.0) < 0.02);
      CHECK(engine.counters().imu_gaps == 0);
    }
  }
}

SCENARIO("the Kalman engine starts on a moving body") {
  GIVEN("a body that moves from the first sample on") {
    const std::uint64_t seed = GENERATE(range(91U, 100U));
    CAPTURE(seed);
    const sim::Recording moving = record("moving_start", 6.0, seed);
    kalman::Engine engine{settings::Settings{}};
    THEN("after two seconds the position is better than a fix, with 2 cm of noise on each axis") {
      CHECK(rms_m(poses_of(engine, moving.events), moving.truth, 2.0) < 0.02 * std::sqrt(3.0));
    }
  }
}

SCENARIO("the Kalman engine starts as uncertain as its first fix") {
  GIVEN("a body at rest, and a first fix that knows its standard deviations") {
    sim::Recording run = record("rest", 3.0);
    const Vector3d std_m(0.3, 0.2, 0.5);
    const auto is_fix = [](const Event& event) { return std::holds_alternative<UltrasonicFix>(event); };
    const auto first = std::find_if(run.events.begin(), run.events.end(), is_fix);
    REQUIRE(first != run.events.end());
    std::get<UltrasonicFix>(*first).covariance_world_m2 =
        Covariance<3>::from_matrix(std_m.cwiseAbs2().asDiagonal());
    const auto next_imu = std::find_if(
        first, run.events.end(), [](const Event& event) { return std::holds_alternative<ImuSample>(event); });
    REQUIRE(next_imu != run.events.end());
    kalman::Engine engine{settings::Settings{}};
    WHEN("it starts the estimate") {
      const auto poses = poses_of(engine, {run.events.begin(), std::next(next_imu)});
      THEN("the position is as uncertain; the unknown velocity and lever arm add less than a fifth") {
        REQUIRE_FALSE(poses.empty());
        const Vector3d pose_std_m = poses.back().pose_covariance.matrix().diagonal().head<3>().cwiseSqrt();
        CHECK((pose_std_m.cwiseQuotient(std_m).array() - 1.0).abs().maxCoeff() < 0.2);
      }
    }
  }
}

SCENARIO("the Kalman engine finds an error of the reported delay") {
  GIVEN("a kart whose fixes report a delay that is wrong by 20 ms") {
    const double reported_minus_true_s = GENERATE(-0.02, 0.02);
    sim::Scenario kart = sim::find_scenario("kart");
    kart.sensors.reported_delay_error_s = reported_minus_true_s;
    const sim::Recording run = sim::record(kart, {.seed = 7, .duration_s = 60.0});
    settings::Settings settings;
    WHEN("the delay is estimated") {
      settings.delay.estimate = true;
      kalman::Engine engine{settings};
      const auto poses = poses_of(engine, run.events);
      THEN("the error of the delay is known to 3 ms, and the position is nearly as good as without one") {
        CHECK(engine.state().filter().delay_error_s == Approx(-reported_minus_true_s).margin(0.003));
        CHECK(rms_m(poses, run.truth, 10.0) < 0.02);
        REQUIRE(engine.estimate().delay_s);
        CHECK(engine.estimate().delay_s->std < 0.003);
      }
      AND_WHEN("that is switched off") {
        settings.delay.estimate = false;
        engine.configure(settings);
        process(engine, *std::find_if(run.events.rbegin(), run.events.rend(), [](const Event& event) {
                  return std::holds_alternative<ImuSample>(event);
                }));
        THEN("the estimate of the running engine ends with the next fix") {
          UltrasonicFix fix;
          fix.position_world_m = engine.state().filter().tracked_position_world_m();
          fix.emission_time_ns = engine.time_ns();
          fix.received_time_ns = engine.time_ns();
          fix.measured_delay_s = 0.0;
          engine.correct(fix);
          CHECK(!engine.estimate().delay_s);
          CHECK(engine.state().filter().delay_error_s == 0.0);
        }
      }
    }
    WHEN("it is not") {
      kalman::Engine engine{settings};
      const auto poses = poses_of(engine, run.events);
      THEN("the position is worse, but by less than the speed times the error") {
        double squares = 0.0;
        for (const TruthSample& truth : run.truth) squares += truth.velocity_world_mps.squaredNorm();
        const double speed_mps = std::sqrt(squares / static_cast<double>(run.truth.size()));
        CHECK(rms_m(poses, run.truth, 10.0) > 0.02);
        CHECK(rms_m(poses, run.truth, 10.0) < speed_mps * std::abs(reported_minus_true_s));
      }
    }
  }
}

SCENARIO("the Kalman engine recovers from what nobody could predict") {
  const auto longest_off_s = [](const char* scenario, std::uint64_t seed) {
    const sim::Recording recording = record(scenario, 60.0, seed);
    kalman::Engine engine{settings::Settings{}};
    auto truth = recording.truth.begin();
    double longest_s = 0.0;
    TimeNs since_ns = 0;
    for (const FusedPose& pose : poses_of(engine, recording.events)) {
      while (truth != recording.truth.end() && truth->time_ns < pose.time_ns) ++truth;
      if (truth == recording.truth.end()) break;
      const bool off = (pose.position_world_m - truth->position_world_m).norm() > 1.0;
      if (!off) since_ns = 0;
      if (off && since_ns == 0) since_ns = pose.time_ns;
      if (off) longest_s = std::max(longest_s, seconds_between(since_ns, pose.time_ns));
    }
    return longest_s;
  };
  GIVEN("gaps of the IMU of up to 5 s, corners and pauses with spikes, or a map that turns") {
    const char* const scenario = GENERATE("imu_gaps", "hall", "moved_map", "hard_stops", "sparse_fixes");
    const std::uint64_t seed = GENERATE(61U, 62U);
    CAPTURE(scenario, seed);
    THEN("the pose is never more than a metre off for longer than 3 s") {
      CHECK(longest_off_s(scenario, seed) < 3.0);
    }
  }
}

}  // namespace kalman_engine_test
