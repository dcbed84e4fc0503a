/// Events that reach the Kalman engine reordered, late, duplicated or restamped.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <utility>
#include <variant>
#include <vector>

namespace kalman_arrivals_test {

using namespace sonopose;
using namespace sonopose::estimation;
using test::poses_of;

sim::Recording record(const char* name, double duration_s, std::uint64_t seed = 5,
                      double imu_rate_hz = 100.0) {
  sim::Scenario scenario = sim::find_scenario(name);
  scenario.sensors.imu_rate_hz = imu_rate_hz;
  return sim::record(scenario, {.seed = seed, .duration_s = duration_s});
}

double apart_deg(const FusedPose& a, const FusedPose& b) {
  return a.q_body_to_world.angularDistance(b.q_body_to_world) / geometry::radians_per_degree;
}

/// Counts the fixes that the engine refuses for their stamps.
int refused_by(kalman::Engine& engine, const std::vector<Event>& events) {
  int refused = 0;
  for (const Event& event : events) {
    const EventResult result = process(engine, event);
    const auto* report = std::get_if<FixReport>(&result);
    if (report != nullptr && (report->flags & (fix_too_late | fix_invalid)) != 0) ++refused;
  }
  return refused;
}

/// Reorders the events as if fixes and headings took up to 0.85 s at random.
std::vector<Event> arrive_at_random(const std::vector<Event>& events, std::uint32_t seed) {
  std::mt19937 random{seed};
  std::uniform_real_distribution<double> late_s(0.0, 0.85);
  std::vector<std::pair<TimeNs, Event>> arrivals;
  for (Event event : events) {
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
  std::vector<Event> sorted;
  for (auto& arrival : arrivals) sorted.push_back(std::move(arrival.second));
  return sorted;
}

SCENARIO("an engine with a fast IMU continues from a snapshot with the same bits") {
  GIVEN("an engine with an IMU of 1 kHz in the middle of a walk, and a copy from its snapshot") {
    const sim::Recording run = record("walk", 6.0, 5, 1000.0);
    const auto half = run.events.begin() + static_cast<std::ptrdiff_t>(run.events.size() / 2 + 3);
    kalman::Engine engine{settings::Settings{}};
    for (auto event = run.events.begin(); event != half; ++event) process(engine, *event);
    kalman::Engine copy{settings::Settings{}};
    copy.restore(engine.snapshot());
    WHEN("both receive the rest") {
      for (auto event = half; event != run.events.end(); ++event) {
        process(engine, *event);
        process(copy, *event);
        REQUIRE(engine.snapshot().history.base.imu.pending_steps.empty());  // pending steps are not stored
      }
      THEN("their states are equal") {
        CHECK(copy.snapshot() == engine.snapshot());
      }
    }
  }
}

SCENARIO("the order of arrival does not matter") {
  GIVEN("runs whose fixes and headings arrive at random within 0.85 s") {
    const char* const scenario = GENERATE("walk", "outlier_bursts", "no_heading", "hall", "moved_map",
                                          "drone", "wrong_tracks", "imu_gaps");
    const std::uint64_t seed = GENERATE(range(71U, 73U));
    const bool is_fast = seed == 71;
    CAPTURE(scenario, seed, is_fast);
    const sim::Recording run = record(scenario, is_fast ? 12.0 : 30.0, seed, is_fast ? 1000.0 : 100.0);
    kalman::Engine in_time{settings::Settings{}};
    kalman::Engine late{settings::Settings{}};
    WHEN("both engines have received everything") {
      const int refused = refused_by(in_time, run.events);
      CHECK(refused_by(late, arrive_at_random(run.events, static_cast<std::uint32_t>(seed))) == refused);
      const TimeNs end_ns = in_time.time_ns();
      // A late fix leaves the estimate at its own time until the next sample, so compare after one more.
      ImuSample imu =
          std::get<ImuSample>(*std::find_if(run.events.rbegin(), run.events.rend(), [](const Event& event) {
            return std::holds_alternative<ImuSample>(event);
          }));
      imu.sensor_time_ns = end_ns + 10'000'000;
      const auto a = in_time.predict(imu);
      const auto b = late.predict(imu);
      THEN("their poses are the same, and their filters have the same bits") {
        REQUIRE(a);
        REQUIRE(b);
        CHECK((a->position_world_m - b->position_world_m).norm() < 1e-3);
        CHECK(apart_deg(*a, *b) < 0.01);
        in_time.finish_pending_work();
        late.finish_pending_work();
        CHECK(late.state().filter() == in_time.state().filter());
      }
    }
  }
}

/// The events with each time of measurement shifted by up to a microsecond.
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

SCENARIO("a microsecond in the stamps decides nothing for long", "[accuracy]") {
  GIVEN("runs with wrong tracks, corners, gaps and an unknown yaw") {
    constexpr double visible_m = 1e-3;
    int visible_runs = 0;
    double longest_s = 0.0;
    for (std::uint32_t i = 0; i < test::seeds(25, 200); ++i) {
      const std::array scenarios{"walk", "kart", "outlier_bursts", "hall", "no_heading"};
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

}  // namespace kalman_arrivals_test
