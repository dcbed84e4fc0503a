/// Status bits that both engines set alike for the same faults of their inputs.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <variant>
#include <vector>

namespace status_bits_test {

using namespace sonopose;
using settings::EngineKind;

constexpr double begins_s = 12.0;
constexpr double ends_s = 16.0;

double seconds_since_start(TimeNs time_ns) {
  return seconds_between(sim::Run{}.start_time_ns, time_ns);
}

TimeNs time_of(const Event& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event)) return imu->sensor_time_ns;
  if (const auto* fix = std::get_if<UltrasonicFix>(&event)) return fix->emission_time_ns;
  return std::get<PairHeading>(event).emission_time_ns;
}

/// Status bits of the poses of a 30 s walk.
class Walk {
public:
  /// `change(event, time_s)` edits each event measured between begins_s and ends_s, or returns false to drop
  /// it.
  Walk(EngineKind engine, const auto& change) {
    settings::Settings settings;
    settings.engine.engine = engine;
    estimation::AnyEstimator estimator{settings};
    const auto events = sim::record(sim::find_scenario("walk"), {.seed = 17, .duration_s = 30.0}).events;
    std::vector<Event> changed;
    for (Event event : events) {
      const double time_s = seconds_since_start(time_of(event));
      if (time_s < begins_s || time_s > ends_s || change(event, time_s)) changed.push_back(event);
    }
    poses_ = test::poses_of(estimator, changed);
  }

  /// Returns true if a pose between these times has the bit.
  [[nodiscard]] bool has(PoseStatus bit, double from_s, double to_s) const {
    return std::any_of(poses_.begin(), poses_.end(), [&](const FusedPose& pose) {
      const double time_s = seconds_since_start(pose.time_ns);
      return time_s >= from_s && time_s <= to_s && (pose.status & bit) != 0;
    });
  }

private:
  std::vector<FusedPose> poses_;
};

UltrasonicFix* fix_of(Event& event) {
  return std::get_if<UltrasonicFix>(&event);
}

SCENARIO("both engines report what happens to their inputs with the same bits") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  CAPTURE(engine == EngineKind::kalman);
  GIVEN("a walk on which nothing happens") {
    const Walk walk(engine, [](Event&, double) { return true; });
    THEN("it is initialising at first, and no other bit is set later") {
      CHECK(walk.has(status_initialising, 0.0, 0.1));
      for (const PoseStatus bit :
           {status_initialising, status_uncalibrated, status_stale, status_converging, status_heading_unknown,
            status_frozen_track, status_imu_gap, status_low_trust, status_rotating_fast,
            status_imu_inconsistent, status_fixes_inconsistent}) {
        CAPTURE(bit);
        CHECK_FALSE(walk.has(bit, 5.0, 30.0));
      }
    }
  }
  GIVEN("a silence of the fixes") {
    const Walk walk(engine, [](Event& event, double) { return fix_of(event) == nullptr; });
    THEN("the pose is stale after a second, until fixes come again") {
      CHECK_FALSE(walk.has(status_stale, 5.0, begins_s + 0.9));
      CHECK(walk.has(status_stale, begins_s + 1.3, begins_s + 1.4));
      CHECK(walk.has(status_stale, ends_s - 0.1, ends_s));
      CHECK_FALSE(walk.has(status_stale, ends_s + 0.5, 30.0));
    }
  }
  GIVEN("fixes that repeat one position") {
    std::optional<Vector3d> first_m;
    const Walk walk(engine, [&](Event& event, double) {
      if (UltrasonicFix* const fix = fix_of(event)) {
        if (!first_m) first_m = fix->position_world_m;
        fix->position_world_m = *first_m;
      }
      return true;
    });
    THEN("the track is frozen until they move again") {
      CHECK_FALSE(walk.has(status_frozen_track, 5.0, begins_s));
      CHECK(walk.has(status_frozen_track, begins_s + 2.0, begins_s + 2.1));
      CHECK(walk.has(status_frozen_track, ends_s - 0.1, ends_s));
      CHECK_FALSE(walk.has(status_frozen_track, ends_s + 1.0, 30.0));
    }
  }
  GIVEN("a silence of the IMU for a second") {
    const Walk walk(engine, [](Event& event, double time_s) {
      return !std::holds_alternative<ImuSample>(event) || time_s > begins_s + 1.0;
    });
    THEN("the first pose after it says so") {
      CHECK(walk.has(status_imu_gap, begins_s + 1.0, begins_s + 1.1));
      CHECK_FALSE(walk.has(status_imu_gap, begins_s + 2.5, 30.0));
    }
  }
  GIVEN("fixes that are moved by 3 m") {
    const Walk walk(engine, [](Event& event, double) {
      if (UltrasonicFix* const fix = fix_of(event)) fix->position_world_m += Vector3d(3.0, 0.0, 0.0);
      return true;
    });
    THEN("the pose converges to them and back") {
      CHECK_FALSE(walk.has(status_converging, 5.0, begins_s));
      CHECK(walk.has(status_converging, begins_s, ends_s));
      CHECK(walk.has(status_converging, ends_s, ends_s + 4.0));
      CHECK_FALSE(walk.has(status_converging, ends_s + 6.0, 30.0));
    }
  }
  GIVEN("fixes of which two in three are metres off, each elsewhere") {
    std::mt19937 random{19};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::uniform_real_distribution<double> anywhere_m(-4.0, 4.0);
    const Walk walk(engine, [&](Event& event, double) {
      if (UltrasonicFix* const fix = fix_of(event); fix != nullptr && random() % 3 != 0) {
        fix->position_world_m += Vector3d(anywhere_m(random), anywhere_m(random), 0.0);
      }
      return true;
    });
    THEN("trust is low meanwhile") {
      CHECK_FALSE(walk.has(status_low_trust, 5.0, begins_s));
      CHECK(walk.has(status_low_trust, begins_s, ends_s));
      CHECK_FALSE(walk.has(status_low_trust, ends_s + 5.0, 30.0));
    }
  }
}

SCENARIO("both engines report a jump of the pose after a silence") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  CAPTURE(engine == EngineKind::kalman);
  GIVEN("a walk without fixes for 3 s, with or without the IMU, after which they are moved by 4 m") {
    const bool imu_is_silent = GENERATE(false, true);
    CAPTURE(imu_is_silent);
    settings::Settings settings;
    settings.engine.engine = engine;
    estimation::AnyEstimator estimator{settings};
    const auto run = sim::record(sim::find_scenario("walk"), {.seed = 18, .duration_s = 20.0});
    std::optional<FixReport> first_used;  // after the silence
    double largest_jump_m = 0.0;          // over fixes that report a jump
    for (Event event : run.events) {
      const double time_s = seconds_since_start(time_of(event));
      const bool in_silence = time_s > 12.0 && time_s < 15.0;
      if (in_silence && (imu_is_silent || !std::holds_alternative<ImuSample>(event))) continue;
      if (UltrasonicFix* const fix = fix_of(event); fix != nullptr && time_s > 12.0) {
        fix->position_world_m += Vector3d(4.0, 0.0, 0.0);
      }
      const auto result = estimation::process(estimator, event);
      const auto* const report = std::get_if<FixReport>(&result);
      if (report == nullptr || time_s < 12.0) continue;
      if (!first_used && (report->flags & fix_used) != 0) first_used = *report;
      if ((report->flags & (fix_stale_recovered | fix_stuck_forced)) != 0) {
        largest_jump_m = std::max(largest_jump_m, report->jump_world_m.norm());
      }
    }
    THEN("the first fix that is used marks the jump") {
      REQUIRE(first_used);
      CHECK((first_used->flags & fix_stale_recovered) != 0);
      CHECK(largest_jump_m > 2.0);
    }
  }
}

SCENARIO("both engines follow a live change of the mount offset") {
  const EngineKind engine = GENERATE(EngineKind::documented, EngineKind::kalman);
  const double change_deg = GENERATE(10.0, 30.0, -90.0);
  CAPTURE(engine == EngineKind::kalman, change_deg);
  GIVEN("a walk with a mount offset that is wrong until 15 s") {
    settings::Settings settings;
    settings.engine.engine = engine;
    settings::Settings wrong = settings;
    wrong.heading.mount_offset_deg -= change_deg;
    estimation::AnyEstimator estimator{wrong};
    const auto run = sim::record(sim::find_scenario("walk"), {.seed = 21, .duration_s = 18.0});
    bool is_right = false;
    std::optional<FusedPose> last;
    for (const Event& event : run.events) {
      const auto result = estimation::process(estimator, event);
      const auto* const pose = std::get_if<FusedPose>(&result);
      if (pose == nullptr) continue;
      if (!is_right && seconds_since_start(pose->time_ns) > 15.0) {
        estimator.configure(settings);
        is_right = true;
      }
      last = *pose;
    }
    THEN("the yaw is right 3 s after the change") {
      const auto truth = std::find_if(run.truth.begin(), run.truth.end(), [&](const TruthSample& sample) {
        return sample.time_ns >= last->time_ns;
      });
      const double yaw_rad = geometry::wrap_angle(geometry::yaw_of(last->q_body_to_world) -
                                                  geometry::yaw_of(truth->q_body_to_world));
      CHECK(std::abs(yaw_rad) < 3.0 * geometry::radians_per_degree);
    }
  }
}

}  // namespace status_bits_test
