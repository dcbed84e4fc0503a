#include "evaluation/score/prediction_errors.hpp"

#include "evaluation/replay/run.hpp"
#include "evaluation/sample_log.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

namespace prediction_errors_test {

using namespace sonopose;
using namespace sonopose::evaluation;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs begin_ns = 1'000'000 * ms;

/// A pose on a straight path along +Y at 2 m/s, turned to the left of the path.
FusedPose pose_at(TimeNs since_begin_ns) {
  FusedPose pose;
  pose.time_ns = begin_ns + since_begin_ns;
  pose.position_world_m = {1.0, 2e-9 * static_cast<double>(since_begin_ns), 0.5};
  pose.velocity_world_mps = {0.0, 2.0, 0.0};
  pose.q_body_to_world = geometry::rotation_about_z(std::numbers::pi);
  return pose;
}

/// A displaced fix on the same path.
UltrasonicFix fix_at(TimeNs since_begin_ns, const Vector3d& by_world_m) {
  UltrasonicFix fix;
  fix.emission_time_ns = begin_ns + since_begin_ns;
  fix.measured_delay_s = 0.07;
  fix.position_world_m = pose_at(since_begin_ns).position_world_m + by_world_m;
  return fix;
}

FixReport report_of(const UltrasonicFix& fix, std::uint32_t flags = fix_used) {
  FixReport report;
  report.innovation_world_m =
      fix.position_world_m - pose_at(fix.emission_time_ns - begin_ns).position_world_m;
  report.emission_time_ns = fix.emission_time_ns;
  report.flags = flags;
  return report;
}

/// Adds poses at 100 Hz for 2 s and calls `on_time(since_begin_ns)` after each.
template <class OnTime>
void drive(PredictionErrors& errors, const OnTime& on_time) {
  for (TimeNs since_ns = 0; since_ns <= 2000 * ms; since_ns += 10 * ms) {
    errors.add(estimation::EventResult(pose_at(since_ns)));
    on_time(since_ns);
  }
}

SCENARIO("a fix is compared with the pose at its emission, along and across the track") {
  GIVEN("fixes that lie 10 cm ahead, 20 cm to the right and 30 cm above, and arrive after 83 ms") {
    PredictionErrors errors(begin_ns, {});
    drive(errors, [&](TimeNs since_ns) {
      if (since_ns < 100 * ms || since_ns % (100 * ms) != 0) return;
      const UltrasonicFix fix = fix_at(since_ns - 83 * ms, {0.2, 0.1, 0.3});
      errors.add(Event(fix));
      errors.add(estimation::EventResult(report_of(fix)));
    });
    const PredictionScore score = errors.score();
    THEN("each error has its sign and size") {
      CHECK(score.fixes.size() == 20);
      CHECK(score.fixes_without == 0);
      CHECK(score.along_m.mean == Approx(0.1));
      CHECK(score.left_m.mean == Approx(-0.2));
      CHECK(score.up_m.mean == Approx(0.3));
      CHECK(score.distance_m.rmse == Approx(std::sqrt(0.14)));
      CHECK(score.distance_p50_m == Approx(std::sqrt(0.14)));
    }
    THEN("errors that stay the same are correlated") {
      CHECK(score.lag_one == Approx(0.95));
    }
  }
  GIVEN("errors that change their sign from fix to fix") {
    PredictionErrors errors(begin_ns, {});
    double sign = 1.0;
    drive(errors, [&](TimeNs since_ns) {
      if (since_ns % (100 * ms) != 0) return;
      const UltrasonicFix fix = fix_at(since_ns, {0.0, sign * 0.1, 0.0});
      errors.add(Event(fix));
      errors.add(estimation::EventResult(report_of(fix)));
      sign = -sign;
    });
    THEN("they are correlated negatively, and have no mean") {
      CHECK(errors.score().lag_one < -0.9);
      CHECK(std::abs(errors.score().along_m.mean) < 0.01);
      CHECK(errors.score().along_m.rms == Approx(0.1));
    }
  }
}

SCENARIO("a fix of a tag is compared with the pose of its place on the body") {
  PredictionErrors errors(begin_ns, {});
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) != 0) return;
    const bool is_left = since_ns % (200 * ms) == 0;
    UltrasonicFix fix = fix_at(since_ns, {0.1, is_left ? -0.3 : 0.3, 0.0});  // the body looks along -X
    fix.point_body_m = {-0.1, is_left ? 0.3 : -0.3, 0.0};
    errors.add(Event(fix));
  });
  CHECK(errors.score().fixes.size() == 21);
  CHECK(errors.score().distance_m.max == Approx(0.0).margin(1e-9));
}

SCENARIO("a mount offset applies to headings of a pair, not to those of the body") {
  settings::Settings settings;
  settings.heading.mount_offset_deg = 90.0;
  const std::uint32_t flags = GENERATE(0U, std::uint32_t{heading_flag_of_body});
  PredictionErrors errors(begin_ns, settings);
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) != 0) return;
    errors.add(Event(PairHeading{.emission_time_ns = begin_ns + since_ns,
                                 .received_time_ns = begin_ns + since_ns,
                                 .heading_world_rad = std::numbers::pi * (flags == 0 ? 1.5 : 1.0),
                                 .valid = true,
                                 .flags = flags}));
  });
  CHECK(errors.score().heading_rad.count == 21);
  CHECK(errors.score().heading_rad.error.rms == Approx(0.0).margin(1e-9));
}

SCENARIO("fixes that the engine gates count in the distances alone") {
  PredictionErrors errors(begin_ns, {});
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) != 0) return;
    const bool wrong = since_ns >= 1000 * ms && since_ns < 1200 * ms;
    const UltrasonicFix fix = fix_at(since_ns, {0.0, wrong ? 50.0 : 0.02, 0.0});
    errors.add(Event(fix));
    // The documented engine uses outliers with a small weight.
    errors.add(estimation::EventResult(report_of(fix, wrong ? fix_used | fix_outlier : fix_used)));
  });
  const PredictionScore score = errors.score();
  CHECK(score.fixes.size() == 21);
  CHECK(score.gated_share == Approx(2.0 / 21.0));
  CHECK(score.distance_m.max == Approx(50.0));
  CHECK(score.along_m.rms == Approx(0.02));
}

SCENARIO("a fix without a pose at its emission is counted, not scored") {
  PredictionErrors errors(begin_ns, {});
  errors.add(Event(fix_at(0, Vector3d::Zero())));
  errors.add(estimation::EventResult(pose_at(0)));
  errors.add(estimation::EventResult(pose_at(500 * ms)));  // too far apart to interpolate
  errors.add(Event(fix_at(250 * ms, Vector3d::Zero())));
  CHECK(errors.score().fixes.size() == 0);
  CHECK(errors.score().fixes_without == 2);
  CHECK(std::isnan(errors.score().distance_m.rmse));
}

SCENARIO("a fix that arrives without delay is compared with the extrapolated pose") {
  PredictionErrors errors(begin_ns, {});
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) == 0) errors.add(Event(fix_at(since_ns + 7 * ms, {0.0, 0.1, 0.0})));
  });
  CHECK(errors.score().fixes.size() == 21);
  CHECK(errors.score().distance_m.rmse == Approx(0.1));
}

SCENARIO("stamps that were an hour ahead do not end the score") {
  PredictionErrors errors(begin_ns, {});
  constexpr TimeNs hour_ns = 3'600'000 * ms;
  errors.add(estimation::EventResult(pose_at(hour_ns)));
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) == 0) errors.add(Event(fix_at(since_ns, Vector3d::Zero())));
  });
  CHECK(errors.score().fixes.size() == 21);
}

SCENARIO("a cost counts the fixes that the reference trusted, at whatever else the candidate trusts") {
  const auto score_of = [](double on_wrong_track_m, double on_good_fixes_m, bool trusts_wrong_track) {
    PredictionErrors errors(begin_ns, {});
    drive(errors, [&](TimeNs since_ns) {
      if (since_ns % (100 * ms) != 0) return;
      const bool wrong = since_ns >= 1000 * ms && since_ns < 1500 * ms;
      const UltrasonicFix fix = fix_at(since_ns, {0.0, wrong ? on_wrong_track_m : on_good_fixes_m, 0.0});
      errors.add(Event(fix));
      errors.add(
          estimation::EventResult(report_of(fix, wrong && !trusts_wrong_track ? fix_outlier : fix_used)));
    });
    return errors.score();
  };
  const PredictionScore reference = score_of(2.0, 0.03, false);
  const PredictionScore follows_the_wrong_track = score_of(0.02, 0.05, true);
  CHECK(cost_of(reference, reference) == Approx(0.03));
  CHECK(cost_of(follows_the_wrong_track, reference) == Approx(0.05));
  CHECK(std::isnan(cost_of(reference, PredictionScore{})));
}

SCENARIO("measurements before the start of the score do not count") {
  PredictionErrors errors(begin_ns + 1000 * ms, {});
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns % (100 * ms) == 0) errors.add(Event(fix_at(since_ns, Vector3d::Zero())));
  });
  CHECK(errors.score().fixes.size() == 11);
}

SCENARIO("the pair's heading is compared with the yaw, less the mount offset") {
  constexpr double mount_rad = 1.2;
  settings::Settings settings;
  settings.heading.mount_offset_deg = mount_rad / geometry::radians_per_degree;
  PredictionErrors errors(begin_ns, settings);
  drive(errors, [&](TimeNs since_ns) {
    PairHeading heading;
    heading.emission_time_ns = begin_ns + since_ns;
    heading.heading_world_rad = geometry::wrap_angle(std::numbers::pi + mount_rad + 0.03);
    heading.valid = since_ns % (100 * ms) == 0;
    errors.add(Event(heading));
  });
  const PredictedQuantity heading = errors.score().heading_rad;
  CHECK(heading.count == 21);
  CHECK(heading.error.mean == Approx(0.03));
  CHECK(heading.p95 == Approx(0.03));
  CHECK_FALSE(errors.score().heading_innovations);  // the noise of headings is unknown
}

SCENARIO("squared errors of headings are normalised by the variances of yaw and heading") {
  PredictionErrors errors(begin_ns, {});
  for (TimeNs since_ns = 0; since_ns <= 2000 * ms; since_ns += 10 * ms) {
    FusedPose pose = pose_at(since_ns);
    pose.pose_covariance = Covariance<6>::from_diagonal({1.0, 1.0, 1.0, 1.0, 1.0, 0.03 * 0.03});
    errors.add(estimation::EventResult(pose));
    PairHeading heading;
    heading.emission_time_ns = begin_ns + since_ns;
    heading.heading_world_rad = geometry::wrap_angle(std::numbers::pi + 0.1);
    heading.valid = since_ns % (100 * ms) == 0;
    errors.add(Event(heading), ScalarEstimate{.value = 0.04});
  }
  const auto innovations = errors.score().heading_innovations;
  REQUIRE(innovations);
  CHECK(innovations->count == 21);
  CHECK(innovations->mean == Approx(4.0));  // 0.1² / (0.03² + 0.04²)
  CHECK(innovations->high - 1.0 == Approx(1.96 * std::sqrt(2.0 / 21.0)));
}

SCENARIO("the speed of the wheels is compared with that of the pose, forwards and backwards") {
  std::vector<recording::WheelSpeed> wheels;
  for (TimeNs since_ns = 5 * ms; since_ns < 2000 * ms; since_ns += 20 * ms) {
    wheels.push_back({begin_ns + since_ns, since_ns < 1000 * ms ? -2.1 : 2.1});
  }
  PredictionErrors errors(begin_ns, {}, wheels);
  drive(errors, [](TimeNs) {});
  const PredictedQuantity speed = errors.score().wheel_speed_mps;
  CHECK(speed.count == wheels.size());
  CHECK(speed.error.mean == Approx(0.1));
}

SCENARIO("squared innovations are normalised by the covariance that the engine reports") {
  PredictionErrors errors(begin_ns, {});
  for (TimeNs i = 0; i < 6; ++i) {
    FixReport report = report_of(fix_at(i * 100 * ms, Vector3d::Zero()));
    report.innovation_world_m = {0.2, -0.2, 0.2};
    report.innovation_covariance_m2 = Covariance<3>::from_diagonal({0.04, 0.02, 0.04});
    errors.add(estimation::EventResult(report));
  }
  const auto innovations = errors.score().innovations;
  REQUIRE(innovations);
  CHECK(innovations->count == 6);
  CHECK(innovations->mean == Approx(4.0 / 3.0));
  CHECK(innovations->high - 1.0 == Approx(1.96 / 3.0));  // √(2 / 18)
  CHECK_FALSE(PredictionErrors(begin_ns, {}).score().innovations);
}

SCENARIO("a delay that is corrected is corrected in the score") {
  settings::Settings settings;
  settings.delay.correction_s = GENERATE(0.0, 0.02);
  PredictionErrors errors(begin_ns, settings);
  drive(errors, [&](TimeNs since_ns) {
    if (since_ns < 200 * ms || since_ns % (100 * ms) != 0) return;
    UltrasonicFix fix = fix_at(since_ns - 90 * ms, Vector3d::Zero());
    fix.emission_time_ns += 20 * ms;  // the reported delay is 20 ms too short
    errors.add(Event(fix));
    errors.add(estimation::EventResult(report_of(fix)));
  });
  const double missed_s = 0.02 - settings.delay.correction_s;
  CHECK(errors.score().along_m.mean == Approx(-2.0 * missed_s).margin(1e-6));  // at 2 m/s
}

SCENARIO("on a simulated walk the Kalman engine leaves nothing to predict") {
  const PredictionScore score = run(test::sample_log("walk", 60.0), {.after_s = 10.0}).prediction;
  CHECK(std::abs(score.lag_one) < 0.25);
  CHECK(std::abs(score.along_m.mean) < 0.01);
  REQUIRE(score.innovations);
  CHECK(score.innovations->mean == Approx(1.0).margin(0.2));
  REQUIRE(score.heading_innovations);
  CHECK(score.heading_innovations->count == score.heading_rad.count);
  CHECK(score.heading_innovations->mean == Approx(1.0).margin(0.25));
}

}  // namespace prediction_errors_test
