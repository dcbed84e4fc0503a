/// The Kalman engine on simulated runs: accuracy, and what arrives in another order or late.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace kalman_engine_test {

using namespace sonopose;
using namespace sonopose::estimation;
using test::poses_of;

sim::Recording record(const char* scenario, double duration_s, std::uint64_t seed = 5) {
  return sim::record(sim::find_scenario(scenario), {.seed = seed, .duration_s = duration_s});
}

/// RMS of the position over the poses after `from_s`.
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

double apart_deg(const FusedPose& a, const FusedPose& b) {
  return a.q_body_to_world.angularDistance(b.q_body_to_world) / geometry::radians_per_degree;
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
        CHECK(std::sqrt(engine.belief().filter().yaw_variance_rad2()) < 0.05);
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
    double most_apart_m = 0.0;
    int poses = 0;
    int without_covariance = 0;
    int other_covariance = 0;
    for (const Event& event : walk.events) {
      const bool started = engine.belief().phase != kalman::Phase::waiting;
      const kalman::Filter before = engine.belief().filter();
      const EventResult output = process(engine, event);
      engine.catch_up();
      const auto* pose = std::get_if<FusedPose>(&output);
      if (pose == nullptr || !started) continue;
      if (seconds_between(walk.truth.front().time_ns, pose->time_ns) < 6.0) continue;  // it stands at first
      ++poses;
      const Vector3d after_world_m = engine.belief().filter().tracked_position_world_m();
      most_apart_m = std::max(most_apart_m, (after_world_m - pose->position_world_m).norm());
      if (!(yaw_std_rad(*pose) > 0.0 && position_std_m(*pose).minCoeff() > 0.0)) ++without_covariance;
      if (!(pose->pose_covariance == before.pose_covariance())) ++other_covariance;
    }
    THEN("while the body walks, the position is that of the filter") {
      CHECK(poses > 1300);
      CHECK(most_apart_m < 0.001);
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
        CHECK(engine.belief().filter().delay_error_s == Approx(-reported_minus_true_s).margin(0.003));
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
          fix.position_world_m = engine.belief().filter().tracked_position_world_m();
          fix.emission_time_ns = engine.time_ns();
          fix.received_time_ns = engine.time_ns();
          fix.measured_delay_s = 0.0;
          engine.correct(fix);
          CHECK(!engine.estimate().delay_s);
          CHECK(engine.belief().filter().delay_error_s == 0.0);
        }
      }
    }
    WHEN("it is not") {
      kalman::Engine engine{settings};
      const auto poses = poses_of(engine, run.events);
      THEN("the speed times the error stays") {
        CHECK(rms_m(poses, run.truth, 10.0) > 0.04);
        CHECK(!engine.estimate().delay_s);
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

SCENARIO("the order of arrival does not matter") {
  GIVEN("a walk whose fixes and headings arrive at random within 0.7 s") {
    const sim::Recording walk = record("walk", 20.0);
    std::mt19937 random{3};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::uniform_real_distribution<double> late_s(0.0, 0.7);
    std::vector<std::pair<TimeNs, Event>> arrivals;
    for (Event event : walk.events) {
      TimeNs at_ns = available_at_ns(event);
      const auto delay = [&](auto& sample) {
        sample.received_time_ns =
            std::max(sample.received_time_ns, sample.emission_time_ns + to_ns(late_s(random)));
        at_ns = sample.received_time_ns;
      };
      if (auto* fix = std::get_if<UltrasonicFix>(&event)) delay(*fix);
      if (auto* heading = std::get_if<PairHeading>(&event)) delay(*heading);
      arrivals.emplace_back(at_ns, event);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    kalman::Engine in_time{settings::Settings{}};
    kalman::Engine late{settings::Settings{}};
    WHEN("both engines have received everything") {
      poses_of(in_time, walk.events);
      for (const auto& arrival : arrivals) process(late, arrival.second);
      const TimeNs end_ns = in_time.time_ns();
      // A late fix leaves the estimate at its time until the next sample: compare after one more.
      ImuSample imu =
          std::get<ImuSample>(*std::find_if(walk.events.rbegin(), walk.events.rend(), [](const Event& event) {
            return std::holds_alternative<ImuSample>(event);
          }));
      imu.sensor_time_ns = end_ns + 10'000'000;
      const auto a = in_time.predict(imu);
      const auto b = late.predict(imu);
      THEN("their poses are the same") {
        REQUIRE(a);
        REQUIRE(b);
        CHECK((a->position_world_m - b->position_world_m).norm() < 1e-3);
        CHECK(apart_deg(*a, *b) < 0.01);
        CHECK(late.counters().fixes_used == in_time.counters().fixes_used);
      }
    }
  }
}

/// The same events with each time of measurement moved by up to a microsecond.
std::vector<Event> jittered(std::vector<Event> events, std::uint32_t seed) {
  std::mt19937 random{seed};
  std::uniform_int_distribution<TimeNs> offset_ns(-1000, 1000);
  for (Event& event : events) {
    if (auto* imu = std::get_if<ImuSample>(&event)) imu->sensor_time_ns += offset_ns(random);
    if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->emission_time_ns += offset_ns(random);
    if (auto* heading = std::get_if<PairHeading>(&event)) heading->emission_time_ns += offset_ns(random);
  }
  return events;
}

SCENARIO("a microsecond in the stamps decides nothing for long") {
  GIVEN("200 runs with wrong tracks, corners and gaps") {
    constexpr double visible_m = 1e-3;
    int visible_runs = 0;
    double longest_s = 0.0;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const std::array scenarios{"walk", "kart", "outlier_bursts", "hall"};
      const sim::Recording run = record(scenarios[i % scenarios.size()], 20.0, 3001 + i);
      kalman::Engine engine{settings::Settings{}};
      kalman::Engine moved{settings::Settings{}};
      const auto poses = poses_of(engine, run.events);
      const auto moved_poses = poses_of(moved, jittered(run.events, i));
      REQUIRE(poses.size() == moved_poses.size());
      TimeNs since_ns = 0;
      bool visible = false;
      for (std::size_t k = 0; k < poses.size(); ++k) {
        const double apart_m = (poses[k].position_world_m - moved_poses[k].position_world_m).norm();
        if (apart_m < visible_m) {
          since_ns = 0;
          continue;
        }
        visible = true;
        if (since_ns == 0) since_ns = poses[k].time_ns;
        longest_s = std::max(longest_s, seconds_between(since_ns, poses[k].time_ns));
      }
      if (visible) ++visible_runs;
    }
    THEN("at most one of them moves by a millimetre, and not for longer than a second") {
      CHECK(visible_runs <= 1);
      CHECK(longest_s <= 1.0);
    }
  }
}

SCENARIO("a fix that is too old or known already says so") {
  GIVEN("an engine in motion") {
    const sim::Recording walk = record("walk", 10.0);
    kalman::Engine engine{settings::Settings{}};
    poses_of(engine, walk.events);
    const auto last = std::find_if(walk.events.rbegin(), walk.events.rend(), [](const Event& event) {
      return std::holds_alternative<UltrasonicFix>(event);
    });
    const auto before = engine.snapshot();
    WHEN("the last fix comes again") {
      const FixReport report = engine.correct(std::get<UltrasonicFix>(*last));
      THEN("it is rejected and changes nothing") {
        CHECK(report.flags == fix_invalid);
        CHECK(engine.snapshot().history == before.history);
      }
    }
    WHEN("a fix of 1.1 s ago arrives") {
      UltrasonicFix old = std::get<UltrasonicFix>(*last);
      old.emission_time_ns = engine.time_ns() - 1'100'000'000;
      old.received_time_ns = engine.time_ns();
      THEN("it is rejected as too late, counted, and changes nothing") {
        const auto rejected = engine.counters().fixes_rejected;
        CHECK(engine.correct(old).flags == fix_too_late);
        CHECK(engine.counters().fixes_rejected == rejected + 1);
        CHECK(engine.snapshot().history == before.history);
      }
    }
  }
  GIVEN("an engine whose first IMU sample was just now") {
    const sim::Recording walk = record("walk", 1.0);
    kalman::Engine engine{settings::Settings{}};
    engine.predict(std::get<ImuSample>(walk.events.front()));
    UltrasonicFix fix;
    fix.position_world_m = {1, 2, 3};
    WHEN("a fix from before that sample arrives") {
      fix.emission_time_ns = engine.time_ns() - 50'000'000;
      fix.received_time_ns = engine.time_ns();
      fix.measured_delay_s = 0.05;
      THEN("it is too late: the engine remembers nothing so old") {
        CHECK(engine.correct(fix).flags == fix_too_late);
      }
    }
    WHEN("a fix from the future arrives") {
      fix.emission_time_ns = engine.time_ns() + 60'000'000'000;
      fix.received_time_ns = fix.emission_time_ns;
      THEN("it is invalid") {
        CHECK(engine.correct(fix).flags == fix_invalid);
      }
    }
  }
}

SCENARIO("stamps that jitter by a microsecond change nothing that matters") {
  GIVEN("a walk with wrong tracks, and the same with jittered stamps") {
    const sim::Recording walk = record("outlier_bursts", 24.0);
    kalman::Engine exact{settings::Settings{}};
    const auto expected = poses_of(exact, walk.events);
    int moved = 0;
    for (unsigned run = 0; run < 20; ++run) {
      std::mt19937 random{run};
      std::uniform_int_distribution<TimeNs> jitter_ns(-1000, 1000);
      std::vector<Event> events = walk.events;
      for (Event& event : events) {
        if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->emission_time_ns += jitter_ns(random);
        if (auto* heading = std::get_if<PairHeading>(&event)) heading->emission_time_ns += jitter_ns(random);
      }
      kalman::Engine engine{settings::Settings{}};
      const auto poses = poses_of(engine, events);
      REQUIRE(poses.size() == expected.size());
      double worst_m = 0.0;
      for (std::size_t i = 200; i < poses.size(); ++i) {
        worst_m = std::max(worst_m, (poses[i].position_world_m - expected[i].position_world_m).norm());
      }
      if (worst_m > 1e-3) ++moved;
    }
    THEN("at most one run differs by more than 1 mm") {
      CHECK(moved <= 1);
    }
  }
}

SCENARIO("the reported deviations are those of the errors") {
  GIVEN("twelve walks") {
    double position = 0.0;
    double velocity = 0.0;
    int count = 0;
    for (std::uint64_t seed = 31; seed < 43; ++seed) {
      const sim::Recording walk = record("walk", 30.0, seed);
      kalman::Engine engine{settings::Settings{}};
      auto truth = walk.truth.begin();
      for (const FusedPose& pose : poses_of(engine, walk.events)) {
        while (truth != walk.truth.end() && truth->time_ns < pose.time_ns) ++truth;
        if (truth == walk.truth.end()) break;
        if (truth->time_ns != pose.time_ns) continue;
        if (seconds_between(walk.truth.front().time_ns, pose.time_ns) < 6.0) continue;
        const Vector3d error_m = pose.position_world_m - truth->position_world_m;
        const Eigen::Matrix3d covariance = pose.pose_covariance.matrix().topLeftCorner<3, 3>();
        position += error_m.dot(covariance.ldlt().solve(error_m)) / 3.0;
        const Vector3d error_mps = pose.velocity_world_mps - truth->velocity_world_mps;
        const Eigen::Matrix3d spread = pose.velocity_covariance.matrix();
        velocity += error_mps.dot(spread.ldlt().solve(error_mps)) / 3.0;
        ++count;
      }
    }
    THEN("the normalised squared errors are about one per degree of freedom") {
      CHECK(position / count > 0.6);
      CHECK(position / count < 1.5);
      CHECK(velocity / count > 0.5);
      CHECK(velocity / count < 1.5);
    }
  }
}

}  // namespace kalman_engine_test
