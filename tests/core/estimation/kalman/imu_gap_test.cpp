/// Fixes and headings during a gap of the IMU.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <vector>

namespace imu_gap_test {

using namespace sonopose;
using namespace sonopose::estimation;
using test::poses_of;

/// A walk without IMU samples from 10 s to 13 s.
struct GapRun {
  TimeNs silent_ns = 0;
  TimeNs resumes_ns = 0;
  std::vector<Event> before;  ///< events that arrive at most 0.2 s after the gap's start
  std::vector<Event> aiding;  ///< later events that are measured and received in the gap
  std::vector<Event> after;
  std::vector<TruthSample> truth;

  explicit GapRun(std::uint64_t seed) {
    const sim::Recording walk = sim::record(sim::find_scenario("walk"), {.seed = seed, .duration_s = 20.0});
    truth = walk.truth;
    silent_ns = truth.front().time_ns + to_ns(10.0);
    resumes_ns = truth.front().time_ns + to_ns(13.0);
    for (const Event& event : walk.events) {
      const TimeNs arrives_ns = available_at_ns(event);
      const auto* imu = std::get_if<ImuSample>(&event);
      const bool silent =
          imu != nullptr && imu->sensor_time_ns > silent_ns && imu->sensor_time_ns < resumes_ns;
      if (silent) continue;
      const bool is_late = arrives_ns < silent_ns + to_ns(0.2);
      (is_late ? before : arrives_ns < resumes_ns ? aiding : after).push_back(event);
    }
  }

  [[nodiscard]] const TruthSample& truth_at(TimeNs time_ns) const {
    return *std::find_if(truth.begin(), truth.end(),
                         [time_ns](const TruthSample& sample) { return sample.time_ns >= time_ns; });
  }
};

UltrasonicFix last_fix(const std::vector<Event>& events) {
  return std::get<UltrasonicFix>(*std::find_if(events.rbegin(), events.rend(), [](const Event& event) {
    return std::holds_alternative<UltrasonicFix>(event);
  }));
}

SCENARIO("fixes during a silence of the IMU show where the body is after it") {
  GIVEN("a walk whose IMU is silent for 3 s") {
    const std::uint64_t seed = GENERATE(range(71U, 77U));
    const bool headings = GENERATE(true, false);
    CAPTURE(seed, headings);
    GapRun run(seed);
    if (!headings) {
      const auto is_heading = [](const Event& event) { return std::holds_alternative<PairHeading>(event); };
      std::erase_if(run.aiding, is_heading);
      std::erase_if(run.after, is_heading);
    }
    kalman::Engine engine{settings::Settings{}};
    poses_of(engine, run.before);
    WHEN("the IMU resumes") {
      int used = 0;
      for (const Event& event : run.aiding) {
        const EventResult result = process(engine, event);
        const auto* report = std::get_if<FixReport>(&result);
        if (report == nullptr) continue;
        CHECK((report->flags & fix_used) != 0);
        ++used;
      }
      CHECK(used >= 15);
      const auto poses = poses_of(engine, run.after);
      THEN("the first pose is off by the motion since the last fix alone") {
        const FusedPose& first = poses.front();
        const TruthSample& truth = run.truth_at(first.time_ns);
        CHECK((first.status & status_imu_gap) != 0);
        CHECK((first.position_world_m - truth.position_world_m).norm() < 0.3);
        CHECK((first.velocity_world_mps - truth.velocity_world_mps).norm() < 1.0);
      }
      THEN("the poses are as good as before after 4 s") {
        for (const FusedPose& pose : poses) {
          if (pose.time_ns < run.resumes_ns + to_ns(4.0)) continue;
          REQUIRE((pose.position_world_m - run.truth_at(pose.time_ns).position_world_m).norm() < 0.1);
        }
      }
    }
  }
}

SCENARIO("an IMU that repeats its last sample is as good as a silent one") {
  const std::uint64_t seed = GENERATE(range(81U, 84U));
  for (const char* const name : {"walk", "kart", "drone"}) {
    CAPTURE(name, seed);
    const sim::Recording recording =
        sim::record(sim::find_scenario(name), {.seed = seed, .duration_s = 20.0});
    const TimeNs start_ns = recording.truth.front().time_ns;
    kalman::Engine engine{settings::Settings{}};
    ImuSample last;
    std::size_t truth = 0;
    double worst_m = 0;
    for (Event event : recording.events) {
      auto* imu = std::get_if<ImuSample>(&event);
      if (imu != nullptr) {
        const double time_s = seconds_between(start_ns, imu->sensor_time_ns);
        if (time_s > 10.0 && time_s < 11.0) {
          imu->angular_velocity_body_radps = last.angular_velocity_body_radps;
          imu->specific_force_body_mps2 = last.specific_force_body_mps2;
        }
        last = *imu;
      }
      const EventResult result = process(engine, event);
      const auto* pose = std::get_if<FusedPose>(&result);
      if (pose == nullptr) continue;
      while (recording.truth[truth].time_ns < pose->time_ns) ++truth;
      if (seconds_between(start_ns, pose->time_ns) < 9.0) continue;
      worst_m = std::max(worst_m, (pose->position_world_m - recording.truth[truth].position_world_m).norm());
      const double time_s = seconds_between(start_ns, pose->time_ns);
      if (time_s > 10.1 && time_s < 11.0) CHECK((pose->status & status_imu_gap) != 0);
    }
    CHECK(worst_m < 0.3);  // as far as the body goes, unseen, in two intervals of the fixes
    CHECK(engine.counters().imu_gaps == 1);
  }
}

SCENARIO("a slow body whose IMU repeats a sample has no IMU until another sample comes") {
  // Straight at 0.5 m/s after three seconds of rest; the IMU repeats from 12 s to 15 s.
  std::mt19937 random{9};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto noise3 = [&] { return Vector3d(noise(random), noise(random), noise(random)); };
  kalman::Engine engine{settings::Settings{}};
  ImuSample imu;
  std::uint64_t sequence = 0;
  for (int i = 0; i < 2000; ++i) {
    const double time_s = 0.01 * i;
    const TimeNs now_ns = 1'000'000'000'000 + to_ns(time_s);
    const double moving_s = std::clamp(time_s - 3.0, 0.0, 1.0);  // time of acceleration, at 0.5 m/s²
    const double way_m = 0.25 * moving_s * moving_s + 0.5 * std::max(0.0, time_s - 4.0);
    imu.sensor_time_ns = now_ns;
    imu.sequence = ++sequence;
    if (time_s < 12.0 || time_s >= 15.0) {
      const double forward_mps2 = time_s >= 3.0 && time_s < 4.0 ? 0.5 : 0.0;
      imu.angular_velocity_body_radps = 0.1 * noise3();
      imu.specific_force_body_mps2 = Vector3d(forward_mps2, 0.0, standard_gravity_mps2) + noise3();
    }
    const EventResult result = process(engine, imu);
    const auto& pose = std::get<FusedPose>(result);
    if (time_s > 12.05 && time_s < 15.0) {
      REQUIRE((pose.status & status_imu_gap) != 0);
      REQUIRE(pose.angular_velocity_body_radps.isZero());
    }
    if (i % 12 != 0) continue;
    UltrasonicFix fix;
    fix.sequence = ++sequence;
    fix.emission_time_ns = fix.received_time_ns = now_ns;
    fix.position_world_m = Vector3d(way_m, 0.0, 1.0) + noise3();
    process(engine, fix);
    PairHeading heading;
    heading.sequence = ++sequence;
    heading.emission_time_ns = heading.received_time_ns = now_ns;
    heading.valid = true;
    process(engine, heading);
  }
  CHECK(engine.counters().imu_gaps == 1);
}

SCENARIO("the order of arrival during a silence of the IMU does not matter") {
  GIVEN("two engines before a silence") {
    const GapRun run(71);
    kalman::Engine in_order{settings::Settings{}};
    poses_of(in_order, run.before);
    kalman::Engine other{settings::Settings{}};
    other.restore(in_order.snapshot());
    poses_of(in_order, run.aiding);
    const auto check_equal = [&] {
      const auto expected = poses_of(in_order, run.after);
      const auto poses = poses_of(other, run.after);
      REQUIRE(poses.size() == expected.size());
      for (std::size_t i = 0; i < poses.size(); ++i) {
        REQUIRE(poses[i].position_world_m == expected[i].position_world_m);
        REQUIRE(poses[i].q_body_to_world.coeffs() == expected[i].q_body_to_world.coeffs());
      }
    };
    WHEN("one receives the fixes and headings of the silence in reverse order") {
      const std::vector<Event> reversed(run.aiding.rbegin(), run.aiding.rend());
      poses_of(other, reversed);
      THEN("the poses after it are the same") {
        check_equal();
      }
    }
    WHEN("one is restored in the middle of the silence") {
      other.restore(in_order.snapshot());
      THEN("the poses after it are the same") {
        check_equal();
      }
    }
  }
}

SCENARIO("a stamp from the future is not a silence of the IMU") {
  GIVEN("an engine in motion, and a fix whose stamps are 5 s ahead") {
    GapRun run(71);
    kalman::Engine engine{settings::Settings{}};
    poses_of(engine, run.before);
    kalman::Engine undisturbed{settings::Settings{}};
    undisturbed.restore(engine.snapshot());
    UltrasonicFix ahead = last_fix(run.before);
    ahead.emission_time_ns += to_ns(5.0);
    ahead.received_time_ns += to_ns(5.0);
    ahead.position_world_m.x() += 1.0;
    engine.correct(ahead);
    WHEN("samples show that the IMU was not silent") {
      std::vector<Event> samples;
      std::copy_if(run.after.begin(), run.after.end(), std::back_inserter(samples),
                   [](const Event& event) { return std::holds_alternative<ImuSample>(event); });
      const TimeNs shift_ns =
          std::get<ImuSample>(samples.front()).sensor_time_ns - engine.time_ns() - 10'000'000;
      for (Event& event : samples) std::get<ImuSample>(event).sensor_time_ns -= shift_ns;
      const auto poses = poses_of(engine, samples);
      THEN("the fix changes no pose") {
        const auto expected = poses_of(undisturbed, samples);
        REQUIRE(poses.size() == expected.size());
        for (std::size_t i = 0; i < poses.size(); ++i) {
          REQUIRE(poses[i].position_world_m == expected[i].position_world_m);
        }
      }
      THEN("another one is invalid") {
        ahead.emission_time_ns = engine.time_ns() + to_ns(5.0);
        ahead.received_time_ns = ahead.emission_time_ns + to_ns(0.07);
        CHECK(engine.correct(ahead).flags == fix_invalid);
      }
    }
  }
}

SCENARIO("a state that is saved in a silence of the IMU continues like the original") {
  GIVEN("a walk whose mount offset is changed in the silence, after fixes of it") {
    const GapRun run(71);
    kalman::Engine engine{settings::Settings{}};
    poses_of(engine, run.before);
    poses_of(engine, run.aiding);
    settings::Settings turned;
    turned.heading.mount_offset_deg = 10.0;
    engine.configure(turned);
    WHEN("another engine continues from its state") {
      kalman::Engine other{turned};
      other.restore(engine.snapshot());
      THEN("both have the same poses") {
        const auto poses = poses_of(engine, run.after);
        const auto other_poses = poses_of(other, run.after);
        REQUIRE(poses.size() == other_poses.size());
        CHECK(std::equal(poses.begin(), poses.end(), other_poses.begin()));
      }
    }
  }
}

}  // namespace imu_gap_test
