/// Tracks of wrong fixes and moving maps, in purpose-made runs.

#include "evaluation/replay/evaluation.hpp"
#include "evaluation/score/score.hpp"
#include "sim/paths.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <variant>
#include <vector>

namespace wrong_tracks_test {

using namespace sonopose;
using estimation::kalman::Engine;

/// Errors of a pose against the truth at its time.
struct PoseError {
  double time_s = 0;
  double position_m = 0;
  double yaw_deg = 0;
  std::uint32_t status = 0;
};

/// Runs the engine on fixes edited by `change(fix, time_s)`.
std::vector<PoseError> errors_in(const sim::Scenario& scenario, std::uint64_t seed, const auto& change) {
  sim::Recording run = sim::record(scenario, {.seed = seed, .duration_s = scenario.duration_s});
  for (Event& event : run.events) {
    auto* const fix = std::get_if<UltrasonicFix>(&event);
    if (fix != nullptr) change(*fix, seconds_between(run.truth.front().time_ns, fix->emission_time_ns));
  }
  evaluation::TruthTrack track(run.truth);
  Engine engine{settings::Settings{}};
  std::vector<PoseError> errors;
  for (const FusedPose& pose : test::poses_of(engine, run.events)) {
    const auto truth = track.at(pose.time_ns);
    if (!truth) continue;
    const double yaw_rad = geometry::wrap_angle(geometry::yaw_of(pose.q_body_to_world) -
                                                geometry::yaw_of(truth->q_body_to_world));
    errors.push_back({seconds_between(run.truth.front().time_ns, pose.time_ns),
                      (pose.position_world_m - truth->position_world_m).norm(),
                      std::abs(yaw_rad) / geometry::radians_per_degree, pose.status});
  }
  return errors;
}

std::vector<PoseError> errors_in(const sim::Scenario& scenario, std::uint64_t seed) {
  return errors_in(scenario, seed, [](UltrasonicFix&, double) {});
}

/// Largest error between two times, m.
double largest_m(const std::vector<PoseError>& errors, double from_s, double to_s) {
  double largest = 0.0;
  for (const PoseError& error : errors) {
    if (error.time_s >= from_s && error.time_s < to_s) largest = std::max(largest, error.position_m);
  }
  return largest;
}

SCENARIO("a map that moves while yaw is searched does not end the search") {
  GIVEN("a body without a heading that rests for 12 s, and a map that shifts at 8 s") {
    sim::Scenario scenario = sim::find_scenario("no_heading");
    scenario.path = [](double time_s) { return sim::walk_path(std::max(0.0, time_s - 9.0)); };
    scenario.disturbances.relocations = {{.at_s = 8.0, .by_world_m = {2.5, 0.0, 0.0}}};
    scenario.duration_s = 30.0;
    const auto seed = GENERATE(range(std::uint64_t{1}, std::uint64_t{7}));
    CAPTURE(seed);
    const auto errors = errors_in(scenario, seed);
    THEN("no yaw is said to be known while it is wrong, and the drive shows it") {
      for (const PoseError& error : errors) {
        if ((error.status & status_heading_unknown) == 0) REQUIRE(error.yaw_deg < 20.0);
      }
      CHECK((errors.back().status & status_heading_unknown) == 0);
      CHECK(errors.back().yaw_deg < 3.0);
      CHECK(largest_m(errors, 20.0, 30.0) < 0.3);
    }
  }
}

SCENARIO("the pose returns from a track that drifted away") {
  const std::uint64_t seed = GENERATE(range(std::uint64_t{1}, std::uint64_t{11}));
  GIVEN("a walk whose fixes drift away by 0.3 m/s for 3 s, once, seed " << seed) {
    sim::Scenario scenario = sim::find_scenario("walk");
    const double begin_s = 12.0 + 0.5 * static_cast<double>(seed);
    scenario.disturbances.outlier_bursts = {
        {.begin_s = begin_s, .duration_s = 3.0, .drift_world_mps = {0.3, 0.0, 0.0}}};
    scenario.duration_s = 25.0;
    const auto errors = errors_in(scenario, seed);
    THEN("it is not lost for 3 s") {
      CHECK(largest_m(errors, begin_s + 3.0 + 3.0, 25.0) < 0.3);
    }
  }
}

SCENARIO("a short reflection does not take the pose away from the fixes that follow it") {
  const std::uint64_t seed = GENERATE(range(std::uint64_t{31}, std::uint64_t{35}));
  const double offset_m = GENERATE(0.3, 0.7);
  GIVEN("a forklift with reflections of 1.6 s, every 5 s, " << offset_m << " m off, seed " << seed) {
    sim::Scenario scenario = sim::find_scenario("forklift");
    scenario.duration_s = 35.0;
    const auto errors = errors_in(scenario, seed, [&](UltrasonicFix& fix, double time_s) {
      if (time_s < 10.0 || std::fmod(time_s, 5.0) > 1.6) return;
      const double direction_rad = 2.1 * std::floor(time_s / 5.0);
      fix.position_world_m += offset_m * Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0.0);
    });
    THEN("the pose follows none of them") {
      CHECK(largest_m(errors, 8.0, 35.0) < 0.25);
    }
  }
}

SCENARIO("heights that jump for some seconds are left out") {
  const std::string name = GENERATE("walk", "drone");
  const std::uint64_t seed = GENERATE(7101U, 7102U);
  GIVEN("a " << name << " whose fixes have mirrored heights for 5 s, seed " << seed) {
    const auto is_mirrored = [](double time_s) { return time_s > 20.0 && time_s < 25.0; };
    const auto errors = errors_in(sim::find_scenario(name), seed, [&](UltrasonicFix& fix, double time_s) {
      if (is_mirrored(time_s)) fix.position_world_m.z() = 0.8 - fix.position_world_m.z();
    });
    THEN("the pose stays on its track") {
      double largest_m = 0.0;
      for (const PoseError& each : errors) {
        if (each.time_s > 15.0) largest_m = std::max(largest_m, each.position_m);
      }
      CHECK(largest_m < 0.4);
    }
  }
  GIVEN("heights that stay 1 m higher") {
    const auto errors = errors_in(sim::find_scenario(name), seed, [](UltrasonicFix& fix, double time_s) {
      if (time_s > 20.0) fix.position_world_m.z() += 1.0;
    });
    THEN("they are believed in the end") {
      CHECK(errors.back().position_m == Approx(1.0).margin(0.15));
    }
  }
}

TEST_CASE("the duration of wrong tracks fades, and others wait at most 1.6 s") {
  constexpr TimeNs now_ns = 1'700'000'000'000'000'000;
  const TimeNs later_ns = now_ns + to_ns(60.0);  // one time constant
  estimation::kalman::WrongTracks tracks;
  CHECK(tracks.wait_s(now_ns) == 0.0);
  tracks.add(1.0, now_ns);
  CHECK(tracks.wait_s(now_ns) == Approx(1.3));
  CHECK(tracks.wait_s(later_ns) == Approx(1.3 / std::exp(1.0)));
  tracks.add(3.0, now_ns);
  CHECK(tracks.wait_s(now_ns) == Approx(1.6));
  CHECK(tracks.wait_s(later_ns) == Approx(1.3 * 3.0 / std::exp(1.0)));
}

SCENARIO("fixes that scatter are noise and no track") {
  GIVEN("a minute of fixes with usual noise, and then with much more") {
    const std::string name = GENERATE("rest", "walk", "forklift");
    const double noise_m = GENERATE(0.1, 0.2, 0.3);
    const auto seed = GENERATE(41U, 42U, 43U);
    CAPTURE(name, noise_m, seed);
    sim::Scenario scenario = sim::find_scenario(name);
    scenario.duration_s = 100.0;
    constexpr double rises_s = 60.0;
    std::mt19937 random{seed};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::normal_distribution<double> error_m(0.0, noise_m);
    const auto errors = errors_in(scenario, seed, [&](UltrasonicFix& fix, double time_s) {
      if (time_s < rises_s) return;
      fix.position_world_m += Vector3d(error_m(random), error_m(random), error_m(random));
    });
    THEN("the pose is not lost, and later within decimetres of the truth") {
      CHECK(largest_m(errors, rises_s, rises_s + 20.0) < 2.0);
      CHECK(largest_m(errors, rises_s + 20.0, scenario.duration_s) < 0.6);
    }
  }
}

SCENARIO("a silence after a jump makes nothing of a few wrong fixes") {
  GIVEN("a walk whose map shifts by 3 m, and whose fixes are silent from when that is followed") {
    sim::Scenario scenario = sim::find_scenario("walk");
    scenario.disturbances.relocations = {{.at_s = 15.0, .by_world_m = {3.0, 0.0, 0.0}}};
    const auto seed = GENERATE(range(std::uint64_t{1}, std::uint64_t{5}));
    CAPTURE(seed);
    const sim::Recording run = sim::record(scenario, {.seed = seed, .duration_s = 30.0});
    Engine engine{settings::Settings{}};
    WHEN("after 8.5 s fixes come that are 12 m off") {
      TimeNs jump_ns = 0;
      int wrong_fixes = 0;
      double largest_jump_m = 0.0;  // caused by a wrong fix
      for (Event event : run.events) {
        auto* const fix = std::get_if<UltrasonicFix>(&event);
        if (fix != nullptr && jump_ns != 0) {
          if (seconds_between(jump_ns, fix->emission_time_ns) < 8.5) continue;
          if (++wrong_fixes > 6) break;
          fix->position_world_m.y() += 12.0;
        }
        const auto result = estimation::process(engine, event);
        const auto* const report = std::get_if<FixReport>(&result);
        if (report == nullptr) continue;
        if (jump_ns == 0 && (report->flags & fix_stuck_forced) != 0) jump_ns = report->emission_time_ns;
        if (wrong_fixes > 0) largest_jump_m = std::max(largest_jump_m, report->jump_world_m.norm());
      }
      THEN("six of them are not enough to start the estimate again") {
        REQUIRE(wrong_fixes > 6);
        CHECK(largest_jump_m < 3.0);
      }
    }
  }
}

SCENARIO("a place of long wrong tracks is remembered") {
  GIVEN("a walk with two wrong tracks of 1.3 s, 3 m off") {
    sim::Scenario scenario = sim::find_scenario("walk");
    scenario.disturbances.outlier_bursts = {
        {.begin_s = 10.0, .duration_s = 1.3, .offset_world_m = {3.0, 0.0, 0.0}},
        {.begin_s = 20.0, .duration_s = 1.3, .offset_world_m = {0.0, 3.0, 0.0}}};
    scenario.duration_s = 30.0;
    const auto seed = GENERATE(range(std::uint64_t{1}, std::uint64_t{5}));
    CAPTURE(seed);
    const auto errors = errors_in(scenario, seed);
    THEN("the first may be followed, as a relocation would be; the second is not") {
      CHECK(largest_m(errors, 19.0, 29.0) < 0.3);
      AND_THEN("the first is left within two fixes after it ends") {
        CHECK(largest_m(errors, 11.6, 19.0) < 0.3);
      }
    }
  }
}

SCENARIO("a map that turns at once is followed by its first fixes and headings") {
  GIVEN("a walk whose map turns by 40 degrees and shifts by 1 m") {
    sim::Scenario scenario = sim::find_scenario("walk");
    scenario.disturbances.relocations = {
        {.at_s = 15.0, .by_world_m = {1.0, 0.0, 0.0}, .turn_rad = 40.0 * geometry::radians_per_degree}};
    scenario.duration_s = 20.0;
    const auto seed = GENERATE(range(std::uint64_t{1}, std::uint64_t{7}));
    CAPTURE(seed);
    const auto errors = errors_in(scenario, seed);
    THEN("the pose is there within a second") {
      CHECK(largest_m(errors, 16.0, 20.0) < 0.2);
      CHECK(errors.back().yaw_deg < 3.0);
    }
  }
}

/// A body that moves at 1 m/s, at one time.
struct Straight {
  double heading_rad = 0.0;
  Vector3d from_world_m = Vector3d::Zero();

  [[nodiscard]] Vector3d at(double time_s) const {
    return from_world_m + time_s * Vector3d(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  }
};

/// Hypothesis of a turned map; null if none.
const estimation::kalman::Hypothesis* turned_in(const Engine& engine) {
  const auto& bank = engine.state().bank;
  const auto found = std::find_if(bank.begin(), bank.end(), [](const auto& each) {
    return each.track == estimation::kalman::Track::turned;
  });
  return found == bank.end() ? nullptr : &*found;
}

SCENARIO("a turned track begins where the body is at the heading that shows the turn") {
  GIVEN(
      "a body that moves straight on, and a map that turns by 40 degrees; headings come 70 ms after fixes") {
    constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;
    constexpr double turned_s = 8.0;
    const Straight before;
    const Straight after{.heading_rad = 40.0 * geometry::radians_per_degree,
                         .from_world_m = {3.0, -2.0, 0.0}};
    const auto map_at = [&](double time_s) { return time_s < turned_s ? before : after; };
    Engine engine{settings::Settings{}};
    for (int k = 0; k < 900 && turned_in(engine) == nullptr; ++k) {
      const double time_s = 0.01 * k;
      const TimeNs now_ns = epoch_ns + to_ns(time_s);
      ImuSample imu;
      imu.sensor_time_ns = imu.bridge_time_ns = now_ns;
      imu.specific_force_body_mps2 = {0.3 * std::sin(20.0 * time_s), 0.0, standard_gravity_mps2};
      engine.predict(imu);
      if (k % 8 == 0) {
        UltrasonicFix fix;
        fix.emission_time_ns = fix.received_time_ns = now_ns;
        fix.measured_delay_s = 0.0;
        fix.position_world_m = map_at(time_s).at(time_s);
        engine.correct(fix);
      }
      if (k % 8 == 7) {
        PairHeading heading;
        heading.emission_time_ns = heading.received_time_ns = now_ns;
        heading.heading_world_rad = map_at(time_s).heading_rad;
        heading.valid = true;
        engine.correct(heading);
      }
    }
    const estimation::kalman::Hypothesis* const turned = turned_in(engine);
    REQUIRE(turned != nullptr);
    THEN("the motion since the last fix is not missing") {
      const double now_s = seconds_between(epoch_ns, engine.state().time_ns);
      CHECK((turned->filter.tracked_position_world_m() - after.at(now_s)).norm() < 0.03);
      CHECK(turned->headings == 0);
    }
  }
}

}  // namespace wrong_tracks_test
