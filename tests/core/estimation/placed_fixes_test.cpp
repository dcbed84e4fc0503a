/// Fixes of several tags, headings of the body with their own noise, and poses that the user sets.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/events.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace placed_fixes_test {

using namespace sonopose;
using estimation::AnyEstimator;
using settings::EngineKind;

settings::Settings settings_of(EngineKind engine) {
  settings::Settings settings;
  settings.engine.engine = engine;
  return settings;
}

sim::Recording record(const char* scenario, double duration_s) {
  return sim::record(sim::find_scenario(scenario), {.seed = 5, .duration_s = duration_s});
}

const TruthSample& truth_at(const sim::Recording& recording, TimeNs time_ns) {
  const auto after = std::ranges::lower_bound(recording.truth, time_ns, {}, &TruthSample::time_ns);
  return after == recording.truth.end() ? recording.truth.back() : *after;
}

double yaw_error_deg(const FusedPose& pose, const TruthSample& truth) {
  return std::abs(geometry::wrap_angle(geometry::yaw_of(pose.q_body_to_world) -
                                       geometry::yaw_of(truth.q_body_to_world))) /
         geometry::radians_per_degree;
}

double error_m(const FusedPose& pose, const TruthSample& truth) {
  return (pose.position_world_m - truth.position_world_m).norm();
}

/// Calls `on_pose(pose, seconds since the start)`.
void run(AnyEstimator& engine, const sim::Recording& recording, const auto& on_event, const auto& on_pose) {
  for (const Event& event : recording.events) {
    Event changed = event;  // NOLINT(performance-unnecessary-copy-initialization): some change it
    if (!on_event(changed)) continue;
    const auto result = estimation::process(engine, changed);
    if (const auto* pose = std::get_if<FusedPose>(&result))
      on_pose(*pose, seconds_between(recording.truth.front().time_ns, pose->time_ns));
  }
}

SCENARIO("two tags on one body show its yaw before it moves") {
  GIVEN(
      "a walk with tags half a metre left and right of the IMU, with headings for the documented engine "
      "alone") {
    const sim::Recording walk = record("walk", 30.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    AnyEstimator engine(settings_of(engine_kind));
    int fixes = 0;
    double worst_m = 0;
    double yaw_at_rest_deg = 180;
    bool yaw_is_known_at_rest = false;
    run(
        engine, walk,
        [&](Event& event) {
          if (std::holds_alternative<PairHeading>(event)) return engine_kind == EngineKind::documented;
          if (auto* const fix = std::get_if<UltrasonicFix>(&event)) {
            fix->point_body_m = {0, ++fixes % 2 == 0 ? 0.5 : -0.5, 0.1};
            fix->position_world_m +=
                truth_at(walk, fix->emission_time_ns).q_body_to_world * fix->point_body_m;
          }
          return true;
        },
        [&](const FusedPose& pose, double time_s) {
          const TruthSample& truth = truth_at(walk, pose.time_ns);
          if (time_s < 2.5 && truth.velocity_world_mps.norm() < 0.01) {
            yaw_at_rest_deg = yaw_error_deg(pose, truth);
            yaw_is_known_at_rest = (pose.status & status_heading_unknown) == 0;
          }
          if (time_s > 8) worst_m = std::max(worst_m, error_m(pose, truth));
        });
    THEN("the Kalman engine knows the yaw at rest, and neither engine takes one tag for the other") {
      CHECK(engine.counters().fixes_rejected <= 10);
      CHECK(worst_m < (engine_kind == EngineKind::kalman ? 0.1 : 0.3));
      if (engine_kind == EngineKind::kalman) {
        CHECK(yaw_is_known_at_rest);
        CHECK(yaw_at_rest_deg < 5.0);
      }
    }
  }
}

SCENARIO("a heading of the body has a noise of its own and no mount offset") {
  GIVEN("a walk with headings of the body, and a pair that is mounted at 90°") {
    const sim::Recording walk = record("walk", 12.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    settings::Settings settings = settings_of(engine_kind);
    settings.heading.mount_offset_deg = 90;
    const auto last_pose = [&](double std_deg) {
      AnyEstimator engine(settings);
      FusedPose last;
      run(
          engine, walk,
          [&](Event& event) {
            if (auto* const heading = std::get_if<PairHeading>(&event)) {
              heading->flags = heading_flag_of_body;
              heading->std_rad = std_deg * geometry::radians_per_degree;
              heading->heading_world_rad =
                  geometry::yaw_of(truth_at(walk, heading->emission_time_ns).q_body_to_world);
            }
            return true;
          },
          [&](const FusedPose& pose, double time_s) {
            if (time_s < 3.0) last = pose;  // it rests: motion shows nothing
          });
      return last;
    };
    const FusedPose certain = last_pose(1.0);
    const FusedPose uncertain = last_pose(30.0);
    const FusedPose unlimited = last_pose(std::numeric_limits<double>::infinity());
    THEN("the yaw is that of the heading") {
      CHECK(yaw_error_deg(certain, truth_at(walk, certain.time_ns)) < 3.0);
    }
    THEN("the Kalman engine's own deviation follows that of the headings") {
      if (engine_kind == EngineKind::kalman) {
        CHECK(yaw_std_rad(certain) < 2.0 * geometry::radians_per_degree);
        CHECK(yaw_std_rad(uncertain) > 4.0 * geometry::radians_per_degree);
        CHECK(yaw_std_rad(unlimited) > yaw_std_rad(uncertain));
        CHECK(unlimited.q_body_to_world.coeffs().allFinite());
      }
    }
  }
}

SCENARIO("a tag that repeats its position does not end those of the others") {
  GIVEN("a walk whose first tag alone repeats one position for 5 s, before two tags alternate") {
    const sim::Recording walk = record("walk", 30.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    AnyEstimator engine(settings_of(engine_kind));
    int fixes = 0;
    std::optional<Vector3d> repeated_m;
    double last_error_m = 0;
    bool is_frozen = false;
    bool was_frozen = false;
    run(
        engine, walk,
        [&](Event& event) {
          auto* const fix = std::get_if<UltrasonicFix>(&event);
          if (fix == nullptr) return true;
          const double time_s = seconds_between(walk.truth.front().time_ns, fix->emission_time_ns);
          const bool repeats = time_s > 10 && time_s < 15;
          fix->point_body_m = {0, repeats || ++fixes % 2 == 0 ? 0.5 : -0.5, 0.1};
          fix->position_world_m += truth_at(walk, fix->emission_time_ns).q_body_to_world * fix->point_body_m;
          if (repeats && !repeated_m) repeated_m = fix->position_world_m;
          if (repeats) fix->position_world_m = *repeated_m;
          return true;
        },
        [&](const FusedPose& pose, double) {
          last_error_m = error_m(pose, truth_at(walk, pose.time_ns));
          is_frozen = (pose.status & status_frozen_track) != 0;
          was_frozen = was_frozen || is_frozen;
        });
    THEN("the repetition is detected, and then their fixes are used again") {
      CHECK(was_frozen);
      CHECK_FALSE(is_frozen);
      CHECK(last_error_m < (engine_kind == EngineKind::kalman ? 0.1 : 0.4));
      CHECK(engine.counters().fixes_used > 200);
    }
  }
}

SCENARIO("a planar body has tags and set poses with places") {
  GIVEN("a forklift whose tag is 1.2 m above and 0.5 m ahead of the IMU, with useless heights") {
    const sim::Recording drive = record("forklift", 25.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    settings::Settings settings = settings_of(engine_kind);
    settings.planar.planar = true;
    settings.planar.height_m = 1.5;
    AnyEstimator engine(settings);
    const Vector3d tag_body_m(0.5, 0, 1.2);
    FusedPose last;
    double worst_m = 0;
    run(
        engine, drive,
        [&](Event& event) {
          if (auto* const fix = std::get_if<UltrasonicFix>(&event)) {
            fix->point_body_m = tag_body_m;
            fix->position_world_m += truth_at(drive, fix->emission_time_ns).q_body_to_world * tag_body_m;
            fix->position_world_m.z() = 40.0;
          }
          return true;
        },
        [&](const FusedPose& pose, double time_s) {
          last = pose;
          if (time_s > 8) worst_m = std::max(worst_m, error_m(pose, truth_at(drive, pose.time_ns)));
        });
    THEN("the body is where it is, at its height") {
      CHECK(worst_m < 0.3);
    }
    WHEN("the user sets a pose on the floor, of a point at the same place") {
      UltrasonicFix fix;
      fix.address = last.address;
      fix.emission_time_ns = fix.received_time_ns = last.time_ns;
      fix.measured_delay_s = 0;
      fix.flags = ultrasonic_flag_set_pose;
      fix.position_world_m = {20, 30, 0};
      fix.covariance_world_m2 = Covariance<3>::from_matrix(0.01 * Eigen::Matrix3d::Identity());
      fix.point_body_m = tag_body_m;
      engine.correct(PairHeading{.address = last.address,
                                 .emission_time_ns = last.time_ns - 1'000'000,
                                 .received_time_ns = last.time_ns - 1'000'000,
                                 .heading_world_rad = 0,
                                 .valid = true,
                                 .std_rad = 0.1,
                                 .flags = heading_flag_of_body | heading_flag_set_pose});
      REQUIRE((engine.correct(fix).flags & fix_used) != 0);
      ImuSample next;
      next.sensor_time_ns = last.time_ns + 10'000'000;
      next.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
      const auto pose = engine.predict(next);
      THEN("it is there, at the height of the settings") {
        REQUIRE(pose);
        CHECK((pose->position_world_m - Vector3d(19.5, 30, 1.5)).norm() < 0.2);
      }
    }
  }
}

SCENARIO("a pose that is refused changes nothing") {
  GIVEN("two engines in the same walk") {
    const sim::Recording walk = record("walk", 25.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    AnyEstimator asked(settings_of(engine_kind));
    AnyEstimator other(settings_of(engine_kind));
    WHEN("the user sets one a pose that is too far away") {
      bool was_asked = false;
      int later_fixes = 0;
      for (const Event& event : walk.events) {
        const auto result = estimation::process(asked, event);
        const auto expected = estimation::process(other, event);
        if (was_asked && std::holds_alternative<UltrasonicFix>(event)) ++later_fixes;
        const auto* const pose = std::get_if<FusedPose>(&result);
        if (pose == nullptr) continue;
        const auto& right = std::get<FusedPose>(expected);
        if (pose->position_world_m != right.position_world_m ||
            pose->q_body_to_world.coeffs() != right.q_body_to_world.coeffs()) {
          FAIL_CHECK("differs " << later_fixes << " fixes after the request");
          break;
        }
        if (was_asked || seconds_between(walk.truth.front().time_ns, pose->time_ns) < 15) continue;
        was_asked = true;
        asked.correct(PairHeading{.address = pose->address,
                                  .emission_time_ns = pose->time_ns - 1'000'000,
                                  .received_time_ns = pose->time_ns - 1'000'000,
                                  .heading_world_rad = geometry::yaw_of(pose->q_body_to_world) + 2,
                                  .valid = true,
                                  .std_rad = 0.1,
                                  .flags = heading_flag_of_body | heading_flag_set_pose});
        UltrasonicFix fix;
        fix.address = pose->address;
        fix.emission_time_ns = fix.received_time_ns = pose->time_ns;
        fix.measured_delay_s = 0;
        fix.flags = ultrasonic_flag_set_pose;
        fix.position_world_m = {1e9, 0, 0};
        CHECK(asked.correct(fix).flags == fix_invalid);
      }
      THEN("its poses are those of the other one, and fix and heading count as refused") {
        CHECK(later_fixes > 50);
        CHECK(asked.counters().fixes_rejected == other.counters().fixes_rejected + 1);
        CHECK(asked.counters().samples_invalid == other.counters().samples_invalid + 1);
      }
    }
  }
}

SCENARIO("the estimate starts again at a pose that the user sets") {
  GIVEN("a walk whose fixes and headings end after 15 s") {
    const sim::Recording walk = record("walk", 25.0);
    const auto engine_kind = GENERATE(EngineKind::kalman, EngineKind::documented);
    AnyEstimator engine(settings_of(engine_kind));
    FusedPose last;
    run(
        engine, walk,
        [&](const Event& event) {
          return std::holds_alternative<ImuSample>(event) ||
                 seconds_between(walk.truth.front().time_ns, available_at_ns(event)) < 15.0;
        },
        [&](const FusedPose& pose, double /*time_s*/) { last = pose; });
    const TruthSample& truth = truth_at(walk, last.time_ns);
    const std::uint32_t resets = last.reset_counter;
    const Vector3d bias_radps = last.gyro_bias_body_radps;
    WHEN(
        "a pose 20 m away and turned by 120° is set, of a point 0.3 m ahead of the IMU, by whatever clock "
        "and delay") {
      constexpr double yaw_rad = 2.0;
      settings::Settings with_delay = engine.settings();
      with_delay.delay.correction_s = GENERATE(-0.4, 0.0, 0.4);
      with_delay.delay.processing_s = 0.4;
      with_delay.delay.source = GENERATE(settings::DelaySource::measured, settings::DelaySource::fixed);
      engine.configure(with_delay);
      const TimeNs stamp_ns = last.time_ns + to_ns(GENERATE(0.0, 2.0, -30.0));
      PairHeading heading{.address = last.address,
                          .emission_time_ns = stamp_ns - 1'000'000,
                          .received_time_ns = stamp_ns - 1'000'000,
                          .heading_world_rad = yaw_rad,
                          .valid = true,
                          .std_rad = 0.1,
                          .flags = heading_flag_of_body | heading_flag_set_pose};
      UltrasonicFix fix;
      fix.address = last.address;
      fix.emission_time_ns = fix.received_time_ns = stamp_ns;
      fix.measured_delay_s = 0;
      fix.flags = ultrasonic_flag_set_pose;
      fix.position_world_m = truth.position_world_m + Vector3d(20, 0, 0);
      fix.covariance_world_m2 = Covariance<3>::from_matrix(0.01 * Eigen::Matrix3d::Identity());
      fix.point_body_m = {0.3, 0, 0};
      engine.correct(heading);
      const FixReport report = engine.correct(fix);
      ImuSample next = test::samples_of<ImuSample>(walk.events).back();
      next.sensor_time_ns = last.time_ns + 10'000'000;
      const auto pose = engine.predict(next);
      THEN("the next pose is there, with the biases that were learned and without a reset") {
        CHECK((report.flags & fix_used) != 0);
        CHECK(report.emission_time_ns == fix.emission_time_ns);
        REQUIRE(pose);
        const Vector3d expected_m =
            fix.position_world_m - Vector3d(0.3 * std::cos(yaw_rad), 0.3 * std::sin(yaw_rad), 0);
        CHECK((pose->position_world_m - expected_m).norm() < 0.15);
        CHECK(std::abs(geometry::wrap_angle(geometry::yaw_of(pose->q_body_to_world) - yaw_rad)) < 0.1);
        CHECK(pose->reset_counter == resets);
        CHECK((pose->gyro_bias_body_radps - bias_radps).norm() < 1e-6);
      }
    }
  }
}

}  // namespace placed_fixes_test
