#include "evaluation/replay/run.hpp"

#include "evaluation/sample_log.hpp"
#include "recording/merge.hpp"
#include "support/events.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

namespace run_test {

using namespace sonopose;
using namespace sonopose::test;
using evaluation::RunOptions;

struct Outputs {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

evaluation::RunResult run_and_record(const recording::SensorLog& log, const RunOptions& options,
                                     Outputs& outputs) {
  return evaluation::run(log, options,
                         {[&outputs](const FusedPose& pose) { outputs.poses.push_back(pose); },
                          [&outputs](const FixReport& report) { outputs.reports.push_back(report); }});
}

TEST_CASE("the same recording and settings give the same bits, other settings give other bits") {
  const recording::SensorLog log = sample_log();
  const auto first = evaluation::run(log, {});
  CHECK(first.state_hash == evaluation::run(log, {}).state_hash);
  CHECK(first.state_hash.size() == 16);
  RunOptions other;
  other.settings.heading.mount_offset_deg += 1.0;
  CHECK(evaluation::run(log, other).state_hash != first.state_hash);
}

TEST_CASE("each IMU sample gives a pose and each fix a report, and both are passed on and counted") {
  const recording::SensorLog log = sample_log();
  Outputs outputs;
  const auto result = run_and_record(log, {}, outputs);
  CHECK(outputs.poses.size() == 2000);  // 20 s at 100 Hz
  CHECK(result.poses == outputs.poses.size());
  CHECK(result.counters.imu_samples == outputs.poses.size());
  CHECK(outputs.reports.size() == result.counters.fixes_used + result.counters.fixes_rejected);
  CHECK(result.fix_flags.of(fix_used) == result.counters.fixes_used);
  CHECK(result.fix_flags.of(fix_first) == 1);
  CHECK(result.events == log.events.size());
  CHECK(result.end.sequence == log.events.size());
  CHECK(result.duration_s == Approx(20.0).margin(0.02));
}

TEST_CASE("the fused pose is compared with the truth, beside the fixes alone") {
  const recording::SensorLog log = sample_log();
  const auto result = evaluation::run(log, {.after_s = 6.0});
  CHECK(result.has_truth);
  CHECK(result.fused.poses == 1400);
  CHECK(result.fused.position_m.rmse < 0.5 * result.last_fix_m.rmse);
  CHECK(result.fused.position_m.p95 < result.fused.position_m.max);
  CHECK(result.fused.velocity_rmse_mps < 0.5);
  CHECK(result.fused.yaw_rmse_deg < 5.0);
  CHECK(result.extrapolated_m.rmse > 0.0);
  CHECK(result.last_fix_m.rmse > 0.02);  // the fixes have a noise of 1.5 cm per axis, and are late
}

TEST_CASE("without truth nothing is scored and all else is the same") {
  recording::SensorLog log = sample_log();
  const auto with_truth = evaluation::run(log, {});
  log.truth.clear();
  const auto without = evaluation::run(log, {});
  CHECK_FALSE(without.has_truth);
  CHECK(std::isnan(without.fused.position_m.rmse));
  CHECK(without.state_hash == with_truth.state_hash);
}

TEST_CASE("a run ends before the first event that comes too late, and reads no further") {
  const recording::SensorLog log = sample_log();
  Outputs outputs;
  const auto result = run_and_record(log, {.until_s = 5.0}, outputs);
  const TimeNs end_ns = available_at_ns(log.events.front()) + to_ns(5.0);
  CHECK(outputs.poses.back().time_ns == end_ns);
  CHECK(outputs.poses.size() == 501);
  CHECK(available_at_ns(log.events[result.end.sequence - 1]) <= end_ns);
  CHECK(available_at_ns(log.events[result.end.sequence]) > end_ns);
}

TEST_CASE("a fix has no effect before it was received") {
  recording::SensorLog log = sample_log("walk", 4.0);
  Outputs as_recorded;
  run_and_record(log, {}, as_recorded);
  // The same recording as merged by a folder's reader, with one fix received a second later.
  const auto imu = test::samples_of<ImuSample>(log.events);
  auto fixes = test::samples_of<UltrasonicFix>(log.events);
  const std::size_t late = fixes.size() / 2;
  std::vector<UltrasonicFix> with_late_fix(fixes.begin(),
                                           fixes.begin() + static_cast<std::ptrdiff_t>(late) + 1);
  with_late_fix.back().received_time_ns += to_ns(1.0);
  fixes.resize(late + 1);
  Outputs early;
  Outputs delayed;
  run_and_record(recording::merge_by_availability("log", imu, fixes, {}), {}, early);
  run_and_record(recording::merge_by_availability("log", imu, with_late_fix, {}), {}, delayed);
  std::size_t first_difference = 0;
  while (first_difference < early.poses.size() &&
         early.poses[first_difference].position_world_m == delayed.poses[first_difference].position_world_m) {
    ++first_difference;
  }
  REQUIRE(first_difference < early.poses.size());
  // The effect starts at the first sample after the fix's receipt, not at its emission.
  CHECK(early.poses[first_difference].time_ns >= fixes[late].received_time_ns);
  CHECK(early.poses[first_difference - 1].time_ns <= fixes[late].received_time_ns);
}

TEST_CASE("impossible rows are counted, and the result stays finite") {
  recording::SensorLog log = sample_log("walk", 5.0);
  std::get<ImuSample>(log.events[0]).angular_velocity_body_radps.x() =
      std::numeric_limits<double>::quiet_NaN();
  test::each<UltrasonicFix>(log.events).front()->position_world_m.y() = 1e9;
  const auto result = evaluation::run(log, {});
  CHECK(result.counters.samples_invalid == 1);
  CHECK(result.fix_flags.of(fix_invalid) == 1);
  CHECK(std::isfinite(result.fused.position_m.max));
}

/// A drive with headings and, after 8 s, velocities of 10 m/s along the body's x axis, whose stamps are
/// ahead.
recording::SensorLog aided_log(double ahead_s) {
  const recording::SensorLog given = sample_log("forklift", 20.0);
  recording::SensorLog log;
  log.truth = given.truth;
  for (Event event : given.events) {
    if (auto* heading = std::get_if<PairHeading>(&event)) {
      heading->emission_time_ns += to_ns(ahead_s);
      heading->received_time_ns += to_ns(ahead_s);
    }
    log.events.push_back(event);
    const auto* imu = std::get_if<ImuSample>(&event);
    if (imu == nullptr || seconds_between(available_at_ns(given.events.front()), imu->sensor_time_ns) < 8.0)
      continue;
    const TimeNs time_ns = imu->sensor_time_ns + to_ns(ahead_s);
    log.events.emplace_back(TwistSample{.emission_time_ns = time_ns,
                                        .received_time_ns = time_ns,
                                        .velocity_body_mps = {10.0, 0.0, 0.0},
                                        .axes = twist_velocity_x});
  }
  std::uint64_t sequence = 0;
  for (Event& event : log.events) std::visit([&](auto& sample) { sample.sequence = ++sequence; }, event);
  return log;
}

TEST_CASE("velocities and headings that cannot be used are named") {
  using Catch::Matchers::Contains;
  const auto ahead = evaluation::run(aided_log(0.7), {});
  REQUIRE(ahead.unused_inputs.size() == 2);
  CHECK_THAT(ahead.unused_inputs[0].text,
             Contains("velocities are not used: they are newer than the IMU samples"));
  CHECK_THAT(ahead.unused_inputs[1].text, Contains("headings are not used"));
  CHECK_FALSE(ahead.unused_inputs[0].is_heading);
  CHECK(ahead.unused_inputs[1].is_heading);
  CHECK(ahead.remarks.empty());
  const auto wrong = evaluation::run(aided_log(0.0), {});
  CHECK(wrong.unused_inputs.empty());
  REQUIRE(wrong.remarks.size() == 1);
  CHECK_THAT(wrong.remarks[0], Contains("velocities contradict the estimate"));
  settings::Settings documented;
  documented.engine.engine = settings::EngineKind::documented;
  const auto unwanted = evaluation::run(aided_log(0.0), {.settings = documented});
  CHECK(unwanted.unused_inputs.empty());
  REQUIRE(unwanted.remarks.size() == 1);
  CHECK_THAT(unwanted.remarks[0], Contains("the documented engine uses none"));
}

TEST_CASE("pure integration starts at the first complete truth and needs one") {
  recording::SensorLog log = sample_log();
  for (std::size_t i = 0; i < 100; ++i) {
    log.truth[i].velocity_world_mps.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  Outputs outputs;
  const RunOptions options{.strapdown = evaluation::strapdown::Rule::previous};
  const auto result = run_and_record(log, options, outputs);
  CHECK(outputs.poses.front().time_ns == log.truth[100].time_ns);
  CHECK(outputs.poses.front().position_world_m == log.truth[100].position_world_m);
  CHECK(outputs.poses.size() == 1900);
  for (const FixReport& report : outputs.reports) REQUIRE(report.flags == 0);  // no fix is used
  CHECK_FALSE(result.prediction.fixes.empty());
  CHECK(result.state_hash == evaluation::run(log, options).state_hash);
  // Steps of 1 mg and 0.02 deg/s integrate to metres within 20 s, neither to kilometres nor to nothing.
  CHECK(result.fused.position_m.max > result.fused.position_m.rmse);
  CHECK(result.fused.position_m.max < 100.0);
  CHECK(result.fused.yaw_rmse_deg < 5.0);
  log.truth.clear();
  CHECK_THROWS_WITH(evaluation::run(log, options), Catch::Contains("starts from the truth"));
}

TEST_CASE("inputs that cannot be run are refused") {
  CHECK_THROWS_WITH(evaluation::run({}, {}), Catch::Contains("no samples"));
  const recording::SensorLog log = sample_log("walk", 1.0);
  evaluation::SavedState beyond;
  beyond.sequence = log.events.size() + 1;
  CHECK_THROWS_WITH(evaluation::run(log, {.start = beyond}), Catch::Contains("from another recording"));
}

}  // namespace run_test
