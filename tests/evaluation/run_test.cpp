#include "evaluation/run.hpp"

#include "evaluation/sample_log.hpp"
#include <sonopose/estimation/documented/engine.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace sonopose;
using namespace sonopose::test;
using evaluation::RunOptions;

namespace {

struct Collected {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

evaluation::RunResult run_and_collect(const recording::SensorLog& log, const RunOptions& options,
                                      Collected& collected) {
  return evaluation::run(log, options,
                         {[&collected](const FusedPose& pose) { collected.poses.push_back(pose); },
                          [&collected](const FixReport& report) { collected.reports.push_back(report); }});
}

}  // namespace

TEST_CASE("the same recording and settings give the same hash, other settings another one") {
  const recording::SensorLog log = sample_log();
  const auto first = evaluation::run(log, {});
  CHECK(first.state_hash == evaluation::run(log, {}).state_hash);
  CHECK(first.state_hash.size() == 16);
  RunOptions other;
  other.settings.attitude.adaptive.adaptive.accel_time_s += 1.0;
  CHECK(evaluation::run(log, other).state_hash != first.state_hash);
}

TEST_CASE("each IMU sample gives a pose and each fix a report, and both are counted") {
  const recording::SensorLog log = sample_log();
  Collected collected;
  const auto result = run_and_collect(log, {}, collected);
  CHECK(collected.poses.size() == 2000);  // 20 s at 100 Hz
  CHECK(result.poses == collected.poses.size());
  CHECK(result.counters.imu_samples == collected.poses.size());
  CHECK(collected.reports.size() == result.counters.fixes_used + result.counters.fixes_rejected);
  CHECK(result.fix_flags.of(fix_used) == result.counters.fixes_used);
  CHECK(result.fix_flags.of(fix_first) == 1);
  CHECK(result.events == log.events.size());
  CHECK(result.end.sequence == log.events.size());
  CHECK(result.duration_s == Approx(20.0).margin(0.02));
}

TEST_CASE("the fused pose and the fixes alone are compared with the truth") {
  const recording::SensorLog log = sample_log();
  const auto result = evaluation::run(log, {.after_s = 6.0});
  CHECK(result.has_truth);
  CHECK(result.fused.poses == 1400);
  CHECK(result.fused.position_m.rmse < 0.5 * result.last_fix_m.rmse);
  CHECK(result.fused.position_m.p95 < result.fused.position_m.max);
  CHECK(result.fused.velocity_rmse_mps < 0.5);
  CHECK(result.fused.yaw_rmse_deg < 5.0);
  CHECK(result.extrapolated_m.rmse > 0.0);
  CHECK(result.last_fix_m.rmse > 0.02);  // the fixes have 1.5 cm of noise per axis and a delay
}

TEST_CASE("without truth nothing is scored and everything else is the same") {
  recording::SensorLog log = sample_log();
  const auto with_truth = evaluation::run(log, {});
  log.truth.clear();
  const auto without = evaluation::run(log, {});
  CHECK_FALSE(without.has_truth);
  CHECK(std::isnan(without.fused.position_m.rmse));
  CHECK(without.state_hash == with_truth.state_hash);
}

TEST_CASE("a run with an end stops before the first later event") {
  const recording::SensorLog log = sample_log();
  Collected collected;
  const auto result = run_and_collect(log, {.until_s = 5.0}, collected);
  const TimeNs end_ns = available_at_ns(log.events.front()) + to_ns(5.0);
  CHECK(collected.poses.back().time_ns == end_ns);
  CHECK(collected.poses.size() == 501);
  CHECK(available_at_ns(log.events[result.end.sequence - 1]) <= end_ns);
  CHECK(available_at_ns(log.events[result.end.sequence]) > end_ns);
}

TEST_CASE("two halves, connected by a saved state, equal the whole run") {
  const recording::SensorLog log = sample_log("outlier_bursts");
  Collected whole_output;
  Collected halves_output;
  const auto whole = run_and_collect(log, {}, whole_output);
  const auto first = run_and_collect(log, {.until_s = 13.0}, halves_output);
  const auto second = run_and_collect(log, {.start = first.end}, halves_output);
  CHECK(second.end == whole.end);
  CHECK(first.events + second.events == whole.events);
  CHECK(first.counters.fixes_used + second.counters.fixes_used == whole.counters.fixes_used);
  REQUIRE(halves_output.poses.size() == whole_output.poses.size());
  for (std::size_t k = 0; k < whole_output.poses.size(); ++k) {
    REQUIRE(halves_output.poses[k].sequence == whole_output.poses[k].sequence);
    REQUIRE(halves_output.poses[k].position_world_m == whole_output.poses[k].position_world_m);
    REQUIRE(halves_output.poses[k].q_body_to_world.coeffs() ==
            whole_output.poses[k].q_body_to_world.coeffs());
  }
}

TEST_CASE("a fix has no effect before it is received") {
  recording::SensorLog log = sample_log("walk", 4.0);
  Collected as_recorded;
  run_and_collect(log, {}, as_recorded);
  // The same recording, merged like a log folder, with one fix received a second later.
  std::vector<ImuSample> imu;
  std::vector<UltrasonicFix> fixes;
  for (const Event& event : log.events) {
    if (const auto* sample = std::get_if<ImuSample>(&event)) imu.push_back(*sample);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) fixes.push_back(*fix);
  }
  const std::size_t late = fixes.size() / 2;
  std::vector<UltrasonicFix> with_late_fix(fixes.begin(),
                                           fixes.begin() + static_cast<std::ptrdiff_t>(late) + 1);
  with_late_fix.back().received_time_ns += to_ns(1.0);
  fixes.resize(late + 1);
  Collected early;
  Collected delayed;
  run_and_collect({recording::merge_by_availability(imu, fixes, {}), {}}, {}, early);
  run_and_collect({recording::merge_by_availability(imu, with_late_fix, {}), {}}, {}, delayed);
  std::size_t first_difference = 0;
  while (first_difference < early.poses.size() &&
         early.poses[first_difference].position_world_m == delayed.poses[first_difference].position_world_m) {
    ++first_difference;
  }
  REQUIRE(first_difference < early.poses.size());
  // The difference starts after the receipt of the fix, not at its emission.
  CHECK(early.poses[first_difference].time_ns >= fixes[late].received_time_ns);
  CHECK(early.poses[first_difference - 1].time_ns <= fixes[late].received_time_ns);
}

TEST_CASE("impossible samples are counted, and the result stays finite") {
  recording::SensorLog log = sample_log("walk", 5.0);
  std::get<ImuSample>(log.events[0]).angular_velocity_body_radps.x() =
      std::numeric_limits<double>::quiet_NaN();
  for (Event& event : log.events) {
    if (auto* fix = std::get_if<UltrasonicFix>(&event)) {
      fix->position_world_m.y() = 1e9;
      break;
    }
  }
  const auto result = evaluation::run(log, {});
  CHECK(result.counters.samples_invalid == 1);
  CHECK(result.fix_flags.of(fix_invalid) == 1);
  CHECK(std::isfinite(result.fused.position_m.max));
}

TEST_CASE("pure integration starts at the first complete truth sample and needs one") {
  recording::SensorLog log = sample_log();
  for (std::size_t i = 0; i < 100; ++i) {
    log.truth[i].velocity_world_mps.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  Collected collected;
  const RunOptions options{.engine = evaluation::EngineKind::strapdown};
  const auto result = run_and_collect(log, options, collected);
  CHECK(collected.poses.front().time_ns == log.truth[100].time_ns);
  CHECK(collected.poses.front().position_world_m == log.truth[100].position_world_m);
  CHECK(collected.poses.size() == 1900);
  CHECK(collected.reports.empty());
  CHECK(result.state_hash == evaluation::run(log, options).state_hash);
  // Steps of 1 mg and 0.02 deg/s integrate to metres within 20 s, not to kilometres and not to zero.
  CHECK(result.fused.position_m.max > result.fused.position_m.rmse);
  CHECK(result.fused.position_m.max < 100.0);
  CHECK(result.fused.yaw_rmse_deg < 5.0);
  log.truth.clear();
  CHECK_THROWS_WITH(evaluation::run(log, options), Catch::Contains("starts from the truth"));
}

TEST_CASE("an empty recording and a state beyond its end are refused") {
  CHECK_THROWS_WITH(evaluation::run({}, {}), Catch::Contains("no samples"));
  const recording::SensorLog log = sample_log("walk", 1.0);
  evaluation::SavedState beyond;
  beyond.sequence = log.events.size() + 1;
  CHECK_THROWS_WITH(evaluation::run(log, {.start = beyond}), Catch::Contains("another recording"));
}
