/// Trust (items 13–22): weights, and the two ways to recover a lost track.

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace trust_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;
using test::epoch_ns;

constexpr double interval_s = 0.08;

/// Settings with round numbers, forced convergence disabled unless a test enables it.
TrustSettings plain() {
  TrustSettings settings;
  settings.sigma_m = 0.1;
  settings.min_weight = 0.002;
  settings.outlier_sigmas = 2.0;
  settings.reference_innovation_m = 1.0;
  settings.n_base = 4;
  settings.n_min = 2;
  settings.n_max = 20;
  settings.stuck_n = 1000;
  return settings;
}

/// A track at rest at the origin, judged fix by fix.
class JudgedTrack {
public:
  explicit JudgedTrack(const TrustSettings& settings) : settings_{settings} {
    trust::restart(state, fix_at(Vector3d::Zero()));
  }

  FixAssessment assess(const Vector3d& position_world_m) {
    now_ns_ += to_ns(interval_s + pause_s);
    body = test::moving_body(velocity_world_mps, now_ns_);
    body.position_world_m = fused_world_m;
    return trust::assess(settings_, state, body, fix_at(position_world_m), velocities);
  }

  FixAssessment assess(double offset_m) { return assess(Vector3d(offset_m, 0, 0)); }

  Vector3d fused_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  double pause_s = 0.0;  ///< in addition to the interval
  std::optional<int> velocities;
  Kinematics body;
  TrustState state;

private:
  [[nodiscard]] TimedFix fix_at(const Vector3d& position_world_m) const {
    return {now_ns_, position_world_m, position_world_m};
  }

  TrustSettings settings_;
  TimeNs now_ns_ = epoch_ns;
};

TEST_CASE("item 13: the weight is one half exactly at sigma and falls with the distance") {
  for (const double sigma_m : {0.06, 0.12, 1.0}) {
    CHECK(trust::weight_of(0.0, sigma_m) == 1.0);
    CHECK(trust::weight_of(sigma_m, sigma_m) == 0.5);
    CHECK(trust::weight_of(2.0 * sigma_m, sigma_m) == Approx(0.2));
    CHECK(trust::weight_of(3.0 * sigma_m, sigma_m) == Approx(0.1));
  }
  JudgedTrack track(plain());
  const FixAssessment assessment = track.assess(0.1);
  CHECK(assessment.innovation_m == Approx(0.1));
  CHECK(assessment.weight == Approx(0.5));
  CHECK_FALSE(assessment.outlier);
}

TEST_CASE("item 13: the innovation is measured from the position that the velocity predicts") {
  JudgedTrack track(plain());
  track.velocity_world_mps = {5, 0, 0};
  CHECK(track.assess(5.0 * interval_s).innovation_m < 1e-9);
  // 10 cm short of the predicted position.
  CHECK(track.assess(10.0 * interval_s - 0.1).innovation_m == Approx(0.1));
}

TEST_CASE("an outlier is beyond the set number of sigmas") {
  JudgedTrack track(plain());
  CHECK_FALSE(track.assess(0.199).outlier);
  JudgedTrack other(plain());
  CHECK(other.assess(0.201).outlier);
}

TEST_CASE("the test ratio is the squared distance over the limit of an outlier") {
  JudgedTrack track(plain());
  CHECK(track.assess(0.1).test_ratio == Approx(0.25));
  JudgedTrack other(plain());
  CHECK(other.assess(0.4).test_ratio == Approx(4.0));
}

TEST_CASE("item 14: no weight is below the floor") {
  TrustSettings settings = plain();
  settings.min_weight = 0.05;
  JudgedTrack track(settings);
  CHECK(track.assess(100.0).weight == Approx(0.05));
  CHECK(track.assess(100.0).weight == Approx(0.05));
  settings.enabled = false;
  JudgedTrack raw(settings);
  CHECK(raw.assess(100.0).weight == Approx(0.05));
}

TEST_CASE("item 15 off: raw weights alone, from the previous fix") {
  TrustSettings settings = plain();
  settings.enabled = false;
  JudgedTrack track(settings);
  CHECK(track.assess(1.0).weight == Approx(1.0 / 101.0));
  CHECK(track.state.trust == 1.0);
  // The wrong track continues and is consistent with itself.
  CHECK(track.assess(1.0).weight == Approx(1.0));
}

TEST_CASE("item 15 on: after an outlier fixes are compared with the IMU's prediction") {
  JudgedTrack track(plain());
  CHECK(track.assess(1.0).outlier);
  CHECK(track.state.trust == 0.0);
  WHEN("the wrong track goes on") {
    const FixAssessment next = track.assess(1.0);
    THEN("it is seen to be wrong still") {
      CHECK(next.outlier);
      CHECK(next.innovation_m == Approx(1.0));
      CHECK(next.weight == Approx(0.002));
    }
  }
  WHEN("the right track comes back") {
    const FixAssessment next = track.assess(0.0);
    THEN("it is no outlier, and trusted by one part of N = 4") {
      CHECK_FALSE(next.outlier);
      CHECK(next.innovation_m < 1e-9);
      CHECK(track.state.trust == Approx(0.25));
      CHECK(next.weight == Approx(0.25));
    }
  }
}

TEST_CASE("items 16–19: full trust takes N = clamp(n_base · jump / reference, n_min, n_max) good fixes") {
  struct Case {
    double jump_m;
    int expected;
  };
  for (const auto& [jump_m, expected] : {Case{1.0, 4}, {2.0, 8}, {0.25, 2}, {3.0, 12}, {4.0, 16}}) {
    JudgedTrack track(plain());
    track.assess(jump_m);
    int fixes = 0;
    double last_trust = 0.0;
    while (track.state.trust < 1.0 && fixes < 100) {
      track.assess(0.0);
      ++fixes;
      CHECK(track.state.trust - last_trust == Approx(1.0 / expected));
      last_trust = track.state.trust;
    }
    INFO("jump " << jump_m);
    CHECK(fixes == expected);
  }
}

TEST_CASE("item 15: an outlier while trust is being rebuilt restarts the rebuilding") {
  JudgedTrack track(plain());
  track.assess(1.0);
  track.assess(0.0);
  track.assess(0.0);
  CHECK(track.state.trust == Approx(0.5));
  track.assess(1.0);
  CHECK(track.state.trust == 0.0);
  track.assess(0.0);
  CHECK(track.state.trust == Approx(0.25));
}

TEST_CASE("item 19: after n_max fixes any track is accepted") {
  TrustSettings settings = plain();
  settings.n_max = 10;
  JudgedTrack track(settings);
  track.assess(3.0);
  int fixes = 1;
  while (track.state.trust < 1.0 && fixes < 100) {
    track.assess(3.0);
    ++fixes;
  }
  // The outlier that lost the trust, then n_max distrusted fixes.
  CHECK(fixes == 11);
  CHECK_FALSE(track.state.forced);
  // The relocated track is now consistent with itself.
  CHECK_FALSE(track.assess(3.0).outlier);
}

TEST_CASE("items 20–22: outliers in a row at zero trust force convergence") {
  TrustSettings settings = plain();
  settings.stuck_n = 5;
  settings.stuck_jump_scale = 0.6;
  settings.stuck_weight_floor = 0.5;
  JudgedTrack track(settings);
  FixAssessment assessment = track.assess(3.0);  // loses the trust
  for (int i = 0; i < 4; ++i) assessment = track.assess(3.0);
  CHECK_FALSE(assessment.forced);
  assessment = track.assess(3.0);  // the fifth at zero trust
  CHECK(assessment.forced);
  CHECK(assessment.jump_floor == 0.6);
  CHECK(assessment.weight_floor == 0.5);

  WHEN("the innovation comes below sigma") {
    track.fused_world_m = {2.95, 0, 0};
    assessment = track.assess(3.0);
    THEN("it ends, with full trust") {
      CHECK_FALSE(assessment.forced);
      CHECK(assessment.jump_floor == 0.0);
      CHECK(track.state.trust == 1.0);
    }
  }
}

TEST_CASE("item 20: a good fix between them restarts the count") {
  TrustSettings settings = plain();
  settings.stuck_n = 5;
  JudgedTrack track(settings);
  track.assess(3.0);
  for (int i = 0; i < 4; ++i) track.assess(3.0);
  track.assess(0.0);
  for (int i = 0; i < 5; ++i) CHECK_FALSE(track.assess(3.0).forced);
}

TEST_CASE(
    "outliers that keep their distance along the IMU's path are a wrong track; a growing one is a pose "
    "astray") {
  JudgedTrack track(plain());
  track.velocity_world_mps = {1, 0, 0};
  track.fused_world_m = {interval_s, 0, 0};
  const auto next_is_forced = [&](double speed_mps, int fixes, double offset_m) {
    bool forced = false;
    double fix_m = offset_m + track.fused_world_m.x();
    for (int i = 0; i < fixes; ++i) {
      forced = track.assess(fix_m).forced || forced;
      track.fused_world_m.x() += interval_s;  // the pose follows the IMU
      fix_m += speed_mps * interval_s;
    }
    return forced;
  };
  WHEN("the fixes are 0.5 m ahead and move as the IMU says") {
    CHECK_FALSE(next_is_forced(1.0, 19, 0.5));  // one fewer than item 19
    THEN("they are counted, and not believed") {
      CHECK(track.state.rivals == 19);
      CHECK(track.state.trust == 0.0);
    }
  }
  WHEN("they move by 2 m/s faster than the IMU says") {
    THEN("convergence is forced within a second, whatever item 20 says") {
      CHECK(next_is_forced(3.0, 12, 0.5));
    }
  }
}

TEST_CASE("a single stray among outliers does not end their track, two begin another") {
  JudgedTrack track(plain());
  for (int i = 0; i < 4; ++i) track.assess(1.0);
  CHECK(track.state.rivals == 4);
  CHECK(track.assess(-2.0).rivals == 0);
  CHECK(track.assess(1.0).rivals == 5);
  track.assess(-2.0);
  CHECK(track.assess(-3.0).rivals == 1);
}

TEST_CASE("after a pause of the fixes, and early in a run, a fix may be farther from its prediction") {
  JudgedTrack soon(plain());
  CHECK(soon.assess(0.3).outlier);
  JudgedTrack late(plain());
  late.pause_s = 0.8;
  CHECK_FALSE(late.assess(0.3).outlier);
  JudgedTrack early(plain());
  early.velocities = 1;
  CHECK_FALSE(early.assess(0.3).outlier);
}

TEST_CASE("items 4, 14, 15, in the engine: a burst of outliers hardly moves the output") {
  test::EngineDriver driver(Settings{}, test::at_rest());
  driver.run(4.0);
  driver.alter_fix = [](UltrasonicFix& fix, double time_s) {
    if (time_s > 5.0 && time_s < 5.5) fix.position_world_m.x() += 2.0;
  };
  driver.run(6.0);
  CHECK(test::worst_error_m(driver.moments, 4.0) < 0.03);
  CHECK(driver.moments.back().position_error_m() < 0.01);
  CHECK_FALSE(driver.moments.back().has(status_low_trust));
}

TEST_CASE("items 19–22, in the engine: a real relocation is followed eventually") {
  test::EngineDriver driver(Settings{}, test::at_rest());
  driver.run(4.0);
  driver.alter_fix = [](UltrasonicFix& fix, double) { fix.position_world_m.x() += 3.0; };
  const auto early = driver.run(0.5);
  CHECK(early.pose.position_world_m.x() < 0.3);
  CHECK(early.has(status_low_trust));
  const auto late = driver.run(3.5);
  CHECK(late.pose.position_world_m.x() == Approx(3.0).margin(0.05));
  bool forced = false;
  for (const auto& report : driver.reports) {
    forced = forced || (report.flags & fix_stuck_forced) != 0;
  }
  CHECK(forced);
}

TEST_CASE("items 20–22, in the engine: a wrong velocity is corrected while convergence is forced") {
  // The IMU reports 2 m/s² for two seconds without ultrasound: a velocity error of 4 m/s.
  Settings settings;
  settings.outage.stale_after_s = 60.0;
  settings.runaway.position_error_m = 1000.0;
  test::Sensors sensors;
  sensors.noise_m = 0.01;  // without noise the coordinates would repeat: a frozen track
  test::EngineDriver driver(settings, test::at_rest(), sensors);
  driver.run(4.0);
  driver.fixes_on = false;
  driver.alter_imu = [](ImuSample& imu, double) { imu.specific_force_body_mps2.x() += 2.0; };
  const auto astray = driver.run(2.0);
  REQUIRE(astray.pose.velocity_world_mps.x() > 3.0);
  driver.alter_imu = nullptr;
  driver.fixes_on = true;
  const auto back = driver.run(7.0);
  CHECK(back.position_error_m() < 0.1);
  CHECK(back.pose.velocity_world_mps.norm() < 0.2);
  CHECK_FALSE(driver.engine.state().trust.forced);
  REQUIRE(driver.reports.back().test_ratio);
  CHECK(*driver.reports.back().test_ratio < 1.0);
}

TEST_CASE("honest fixes win the pose back within a second from a wrong velocity") {
  // A spike has removed the trust when the IMU's velocity drops by 1.5 m/s during a drive at 2 m/s.
  test::Sensors sensors = test::with_headings(0.02);
  test::EngineDriver driver(Settings{}, test::departure(2.0), sensors);
  driver.run(6.0);
  driver.alter_fix = [](UltrasonicFix& fix, double time_s) {
    if (time_s > 6.0 && time_s < 6.1) fix.position_world_m.y() += 2.0;
  };
  driver.alter_imu = [](ImuSample& imu, double time_s) {
    if (time_s > 6.1 && time_s < 6.4) imu.specific_force_body_mps2.x() -= 5.0;
  };
  driver.run(0.5);
  REQUIRE(driver.moments.back().pose.velocity_world_mps.x() < 1.0);
  driver.run(3.5);
  CHECK(test::worst_error_m(driver.moments, 5.0) < 1.0);
  double last_far_s = 0.0;
  for (const auto& moment : driver.moments) {
    if (moment.time_s > 6.5 && moment.position_error_m() > 0.3) last_far_s = moment.time_s;
  }
  CHECK(last_far_s < 7.5);
  CHECK(driver.moments.back().position_error_m() < 0.1);
}

}  // namespace trust_test
