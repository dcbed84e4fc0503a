/// The motion of a state's filters, and doubtful fixes, for a body that moves along x at 1 m/s.

#include <sonopose/estimation/kalman/state.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace kalman_state_test {

using namespace sonopose;
namespace kalman = estimation::kalman;
using estimation::kalman::FixMeasurement;
using estimation::kalman::FixOutcome;
using estimation::kalman::Phase;
using estimation::kalman::State;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;
constexpr double imu_step_s = 0.01;
constexpr int imu_per_fix = 8;

/// The truth and a state that is fed its samples.
struct Drive {
  settings::Settings settings;
  State state;
  double time_s = 0.0;

  [[nodiscard]] Vector3d truth_world_m() const { return {time_s, 0.0, 0.0}; }
  [[nodiscard]] double error_m() const {
    return (state.filter().tracked_position_world_m() - truth_world_m()).norm();
  }

  void imu() {
    time_s += imu_step_s;
    estimation::kalman::ImuMeasurement sample;
    sample.time_ns = epoch_ns + to_ns(time_s);
    sample.force_body_mps2 = {0.3 * std::sin(20.0 * time_s), 0.0, standard_gravity_mps2};  // no rest
    state.on_imu(settings, sample);
  }

  FixOutcome fix(const Vector3d& off_world_m = Vector3d::Zero()) {
    FixMeasurement measured;
    measured.time_ns = measured.stamp_ns = epoch_ns + to_ns(time_s);
    measured.position_world_m = truth_world_m() + off_world_m;
    return state.on_fix(settings, measured);
  }

  /// Feeds IMU samples up to the next fix, then that fix.
  FixOutcome next_fix(const Vector3d& off_world_m = Vector3d::Zero()) {
    for (int k = 0; k < imu_per_fix; ++k) imu();
    return fix(off_world_m);
  }

  void next_heading() {
    state.on_heading(settings, {.time_ns = epoch_ns + to_ns(time_s),
                                .stamp_ns = epoch_ns + to_ns(time_s),
                                .heading_world_rad = 0.0});
  }
};

/// A drive after 8 s of correct fixes and headings.
Drive settled() {
  Drive drive;
  drive.imu();
  drive.next_heading();
  for (int k = 0; k < 100; ++k) {
    drive.next_fix();
    drive.next_heading();
  }
  REQUIRE(drive.state.phase == Phase::tracking);
  REQUIRE(drive.error_m() < 0.01);
  return drive;
}

SCENARIO("a former track is taken back for fixes that the present one does not explain") {
  GIVEN("a former track 0.5 m beside the filter, and fixes along it that the filter rejects") {
    Drive drive = settled();
    const Vector3d beside_m{0.0, 0.5, 0.0};
    kalman::Hypothesis& former = drive.state.bank.spawn(drive.state.bank.best());
    former.track = kalman::Track::former;
    former.explained_ns = epoch_ns + to_ns(drive.time_s);
    former.filter.position_world_m += beside_m;
    const auto follow = [&] {
      for (int k = 0; k < 4; ++k) drive.next_fix(beside_m);
      return drive.error_m();
    };
    WHEN("its position is certain to some centimetres") {
      THEN("the pose returns to it") {
        CHECK(follow() == Approx(0.5).margin(0.05));
      }
    }
    WHEN("its standard deviation is as large as its distance, so that it explains any fix nearby") {
      former.filter.add_variance(estimation::kalman::at_position, Vector3d::Constant(0.5 * 0.5));
      THEN("the pose stays with the truth") {
        CHECK(follow() < 0.05);
      }
    }
  }
}

SCENARIO("all filters follow the motion between two fixes, however fast the IMU is") {
  GIVEN("equal filters, and 0.9 s without a fix, with rates of up to 3 rad/s and forces of up to 6 m/s²") {
    // Alternating IMU steps, ms. While tracking, those of the first two rows are too long to be joined.
    const std::vector<int> steps_ms =
        GENERATE(std::vector{10}, std::vector{5, 15}, std::vector{5}, std::vector{3}, std::vector{1},
                 std::vector{1, 1, 1, 1, 1, 1, 1, 1, 1, 20});
    const bool is_searching = GENERATE(false, true);
    CAPTURE(steps_ms, is_searching);
    Drive drive = settled();
    State& state = drive.state;
    if (is_searching) state.phase = kalman::Phase::searching_yaw;
    const kalman::Filter start = state.filter();
    for (const kalman::Track track : {kalman::Track::other, kalman::Track::former}) {
      state.bank.spawn(state.bank.best()).track = track;
      state.bank.find(track)->explained_ns = state.time_ns;
    }
    for (kalman::Hypothesis& each : state.bank) each.filter = start;
    kalman::Filter each_step = start;  // makes every step on its own
    double off_m = 0.0;
    int since_ms = 0;
    for (std::size_t k = 0; since_ms < 896; ++k) {  // one second later velocities are bounded
      since_ms += steps_ms[k % steps_ms.size()];
      const double since_s = 1e-3 * since_ms;
      const double turn = std::sin(9.0 * since_s);
      const kalman::ImuMeasurement imu{.time_ns = epoch_ns + to_ns(drive.time_s + since_s),
                                       .rate_body_radps = 3.0 * turn * Vector3d(0.5, -0.3, 0.8),
                                       .force_body_mps2 = {5.0 * turn, -3.0 * turn, standard_gravity_mps2}};
      const kalman::ImuStep step = kalman::step_between({.time_ns = state.imu.time_ns,
                                                         .rate_body_radps = state.imu.rate_body_radps,
                                                         .force_body_mps2 = state.imu.force_body_mps2},
                                                        imu, state.imu.nominal_imu_period_s);
      each_step.predict(step.rate_body_radps, step.force_body_mps2, step.duration_s);
      const kalman::NominalState expected = state.nominal_after(step);
      state.on_imu(drive.settings, imu);
      CHECK(state.nominal() == expected);
      off_m = std::max(off_m, (expected.position_world_m - each_step.position_world_m).norm());
      CHECK((expected.angular_velocity_body_radps - each_step.angular_velocity_body_radps).norm() < 1e-12);
      CHECK((expected.acceleration_world_mps2 - each_step.acceleration_world_mps2).norm() < 2e-3);
    }
    THEN("no pose is off by more than 0.3 mm") {
      CHECK(off_m < 3e-4);
    }
    WHEN("a fix or heading needs them") {
      state.propagate();
      THEN("they differ as little from one that made every step, and not at all if no steps were joined") {
        REQUIRE((each_step.position_world_m - start.position_world_m).norm() > 0.5);
        REQUIRE(state.bank.size() == kalman::closed_model_count + 3);  // and `wrong_headings`
        for (const kalman::Hypothesis& each : state.bank) {
          const kalman::Filter& filter = each.filter;
          CHECK((filter.position_world_m - each_step.position_world_m).norm() < 2e-4);
          CHECK((filter.velocity_world_mps - each_step.velocity_world_mps).norm() < 1e-3);
          CHECK(filter.q_body_to_world.angularDistance(each_step.q_body_to_world) < 1e-5);
          if (!is_searching && steps_ms.back() > 5 && steps_ms.size() < 3)
            CHECK(filter.position_world_m == each_step.position_world_m);
        }
      }
    }
  }
}

SCENARIO("a doubtful fix after rejected ones moves the pose by its weight") {
  GIVEN("an estimate that is uncertain by 1 m, where a fix alone would place it") {
    Drive drive = settled();
    for (int k = 0; k < imu_per_fix; ++k) drive.imu();
    const bool after_rejected = GENERATE(false, true);
    if (after_rejected) {
      REQUIRE(drive.fix({20.0, 0.0, 0.0}).flags != fix_used);
      REQUIRE(drive.state.fixes.rejected_in_row == 1);
    }
    for (kalman::Hypothesis& each : drive.state.bank) {
      each.filter.add_variance(estimation::kalman::at_position, Vector3d::Ones());
    }
    WHEN("a fix comes that is 4 standard deviations away") {
      const FixOutcome outcome = drive.fix({0.0, 4.0, 0.0});
      REQUIRE(outcome.flags == fix_used);
      REQUIRE(outcome.weight == Approx(7.8 / 16.0).margin(0.03));
      const double share = outcome.jump_world_m.norm() / 4.0;
      if (after_rejected) {
        THEN("the pose goes as far as the weight says") {
          CHECK(share == Approx(outcome.weight).margin(0.02));
        }
      } else {
        THEN("the fix alone is in doubt, and it is far more certain than the estimate") {
          CHECK(share > 0.95);
        }
      }
    }
  }
}

/// Duration for which fixes 3 m off must persist until the pose follows them, s.
double time_until_followed_s(Drive& drive) {
  const Vector3d off_m{0.0, 3.0, 0.0};
  const double begin_s = drive.time_s;
  while (drive.time_s - begin_s < 5.0) {
    drive.next_fix(off_m);
    if (std::abs(drive.error_m() - off_m.norm()) < 0.3) break;
  }
  return drive.time_s - begin_s;
}

SCENARIO("a place of long wrong tracks makes others wait") {
  GIVEN("a place of long wrong tracks") {
    Drive drive = settled();
    drive.state.wrong_tracks.add(10.0, epoch_ns + to_ns(drive.time_s));
    WHEN("a track begins after correct fixes") {
      THEN("it is followed after 1.6 s") {
        CHECK(time_until_followed_s(drive) == Approx(1.6).margin(2.0 * imu_step_s * imu_per_fix));
      }
    }
  }
}

}  // namespace kalman_state_test
