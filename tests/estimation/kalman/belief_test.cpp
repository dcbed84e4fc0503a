/// How a belief moves its filters, and what it makes of doubtful fixes: of a body that moves by 1 m/s along
/// x.

#include <sonopose/estimation/kalman/belief.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace kalman_belief_test {

using namespace sonopose;
namespace kalman = estimation::kalman;
using estimation::kalman::Belief;
using estimation::kalman::FixMeasurement;
using estimation::kalman::FixOutcome;
using estimation::kalman::Phase;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;
constexpr double imu_step_s = 0.01;
constexpr int imu_per_fix = 8;

/// The truth, and what a belief makes of its samples.
struct Drive {
  settings::Settings settings;
  Belief belief;
  double time_s = 0.0;

  [[nodiscard]] Vector3d truth_world_m() const { return {time_s, 0.0, 0.0}; }
  [[nodiscard]] double error_m() const {
    return (belief.filter().tracked_position_world_m() - truth_world_m()).norm();
  }

  void imu() {
    time_s += imu_step_s;
    estimation::kalman::ImuMeasurement sample;
    sample.time_ns = epoch_ns + to_ns(time_s);
    sample.force_body_mps2 = {0.3 * std::sin(20.0 * time_s), 0.0, standard_gravity_mps2};  // no rest
    belief.on_imu(settings, sample);
  }

  FixOutcome fix(const Vector3d& off_world_m = Vector3d::Zero()) {
    FixMeasurement measured;
    measured.time_ns = measured.stamp_ns = epoch_ns + to_ns(time_s);
    measured.position_world_m = truth_world_m() + off_world_m;
    return belief.on_fix(settings, measured);
  }

  /// IMU samples up to the next fix, and that fix.
  FixOutcome next_fix(const Vector3d& off_world_m = Vector3d::Zero()) {
    for (int k = 0; k < imu_per_fix; ++k) imu();
    return fix(off_world_m);
  }

  void next_heading() {
    belief.on_heading(settings, {.time_ns = epoch_ns + to_ns(time_s),
                                 .stamp_ns = epoch_ns + to_ns(time_s),
                                 .heading_world_rad = 0.0});
  }
};

/// After 8 s of correct fixes and headings.
Drive settled() {
  Drive drive;
  drive.imu();
  drive.next_heading();
  for (int k = 0; k < 100; ++k) {
    drive.next_fix();
    drive.next_heading();
  }
  REQUIRE(drive.belief.phase == Phase::tracking);
  REQUIRE(drive.error_m() < 0.01);
  return drive;
}

SCENARIO("a former track is taken back for fixes that the present one does not explain") {
  GIVEN("a former track 0.5 m beside the filter, and fixes along it that the filter rejects") {
    Drive drive = settled();
    const Vector3d beside_m{0.0, 0.5, 0.0};
    auto& former = drive.belief.former;
    former.alive = true;
    former.is_anchor = false;
    former.left_ns = epoch_ns + to_ns(drive.time_s);
    former.filter = drive.belief.filter();
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
    // The steps of the IMU in turn, ms. While tracking, those of the first two rows are too long to be
    // joined.
    const std::vector<int> steps_ms =
        GENERATE(std::vector{10}, std::vector{5, 15}, std::vector{5}, std::vector{3}, std::vector{1},
                 std::vector{1, 1, 1, 1, 1, 1, 1, 1, 1, 20});
    const bool is_searching = GENERATE(false, true);
    CAPTURE(steps_ms, is_searching);
    Drive drive = settled();
    Belief& belief = drive.belief;
    if (is_searching) belief.phase = kalman::Phase::searching_yaw;
    const kalman::Filter start = belief.filter();
    belief.candidate_count = kalman::model_count;
    for (auto& candidate : belief.candidates) candidate.filter = start;
    REQUIRE(belief.former.alive);
    belief.former.filter = start;
    belief.rival.alive = true;
    belief.rival.filter = start;
    kalman::Filter each_step = start;  // one that makes every step
    double off_m = 0.0;
    int since_ms = 0;
    for (std::size_t k = 0; since_ms < 896; ++k) {  // one second later velocities are bounded
      since_ms += steps_ms[k % steps_ms.size()];
      const double since_s = 1e-3 * since_ms;
      const double turn = std::sin(9.0 * since_s);
      const kalman::ImuMeasurement imu{.time_ns = epoch_ns + to_ns(drive.time_s + since_s),
                                       .rate_body_radps = 3.0 * turn * Vector3d(0.5, -0.3, 0.8),
                                       .force_body_mps2 = {5.0 * turn, -3.0 * turn, standard_gravity_mps2}};
      const kalman::ImuStep step = kalman::step_between({.time_ns = belief.time_ns,
                                                         .rate_body_radps = belief.rate_body_radps,
                                                         .force_body_mps2 = belief.force_body_mps2},
                                                        imu, belief.usual_step_s);
      each_step.predict(step.rate_body_radps, step.force_body_mps2, step.duration_s);
      const kalman::NominalState expected = belief.nominal_after(step);
      belief.on_imu(drive.settings, imu);
      CHECK(belief.nominal() == expected);
      off_m = std::max(off_m, (expected.position_world_m - each_step.position_world_m).norm());
      CHECK((expected.angular_velocity_body_radps - each_step.angular_velocity_body_radps).norm() < 1e-12);
      CHECK((expected.acceleration_world_mps2 - each_step.acceleration_world_mps2).norm() < 2e-3);
    }
    THEN("no pose is off by more than 0.3 mm") {
      CHECK(off_m < 3e-4);
    }
    WHEN("a fix or heading needs them") {
      belief.propagate();
      THEN("they differ as little from one that made every step, and not at all if no steps were joined") {
        REQUIRE((each_step.position_world_m - start.position_world_m).norm() > 0.5);
        std::vector<const kalman::Filter*> filters{&belief.former.filter, &belief.rival.filter};
        for (std::size_t i = 0; i < kalman::model_count; ++i) filters.push_back(&belief.candidates[i].filter);
        for (const kalman::Filter* filter : filters) {
          CHECK((filter->position_world_m - each_step.position_world_m).norm() < 2e-4);
          CHECK((filter->velocity_world_mps - each_step.velocity_world_mps).norm() < 1e-3);
          CHECK(filter->q_body_to_world.angularDistance(each_step.q_body_to_world) < 1e-5);
          if (!is_searching && steps_ms.back() > 5 && steps_ms.size() < 3)
            CHECK(filter->position_world_m == each_step.position_world_m);
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
      REQUIRE(drive.belief.fixes_rejected_in_row == 1);
    }
    for (auto& candidate : drive.belief.candidates) {
      candidate.filter.add_variance(estimation::kalman::at_position, Vector3d::Ones());
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

/// For how long fixes 3 m off must last until the pose follows them, s.
double time_until_followed_s(Drive& drive) {
  const Vector3d off_m{0.0, 3.0, 0.0};
  const double begin_s = drive.time_s;
  while (drive.time_s - begin_s < 5.0) {
    drive.next_fix(off_m);
    if (std::abs(drive.error_m() - off_m.norm()) < 0.3) break;
  }
  return drive.time_s - begin_s;
}

SCENARIO("an estimate that explains no fix for long is replaced sooner") {
  GIVEN("a place of long wrong tracks, so that another track must last 1.6 s to be believed") {
    Drive drive = settled();
    drive.belief.wrong_tracks.add(10.0, epoch_ns + to_ns(drive.time_s));
    WHEN("a track begins after correct fixes") {
      THEN("it is followed after 1.6 s") {
        CHECK(time_until_followed_s(drive) == Approx(1.6).margin(2.0 * imu_step_s * imu_per_fix));
      }
    }
    WHEN("it begins after 5 s of fixes here and there") {
      for (int k = 0; k < 62; ++k) {
        const double side = k % 2 == 0 ? 1.0 : -1.0;
        drive.next_fix({side * (20.0 + 7.0 * (k % 3)), side * 30.0, 5.0 * (k % 5)});
      }
      THEN("it is followed in 3 s out of more than 5 s of that time") {
        CHECK(time_until_followed_s(drive) < 1.2);
      }
    }
    WHEN("it begins after a silence of 5 s") {
      for (int k = 0; k < 500; ++k) drive.imu();
      THEN("the silence counts for nothing") {
        CHECK(time_until_followed_s(drive) > 0.8);
      }
    }
  }
}

}  // namespace kalman_belief_test
