#include "evaluation/report/report.hpp"

#include "evaluation/sample_log.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace report_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("the JSON report contains the figures of the run") {
  const auto result = evaluation::run(sample_log(), {.after_s = 6.0});
  const json report = json::parse(evaluation::report_json(result, {0.5, 1.5}));
  CHECK(report["position_rmse_m"] == result.fused.position_m.rmse);
  CHECK(report["position_p95_m"] == result.fused.position_m.p95);
  CHECK(report["position_max_m"] == result.fused.position_m.max);
  CHECK(report["yaw_rmse_deg"] == result.fused.yaw_rmse_deg);
  CHECK(report["tilt_rmse_deg"] == result.fused.tilt_rmse_deg);
  CHECK(report["velocity_rmse_mps"] == result.fused.velocity_rmse_mps);
  CHECK(report["last_fix_rmse_m"] == result.last_fix_m.rmse);
  CHECK(report["extrapolated_rmse_m"] == result.extrapolated_m.rmse);
  CHECK(report["fixes_used"] == result.counters.fixes_used);
  CHECK(report["fixes_rejected"] == 0);
  CHECK(report["fixes_down_weighted"] == result.fixes_down_weighted);
  CHECK(report["imu_samples"] == 2000);
  CHECK(report["poses_without_truth"] == 0);
  CHECK(report["imu_stamps_back"] == 0);
  CHECK(report["state_hash"] == result.state_hash);
  CHECK(report["prediction"]["distance_rms_m"] == result.prediction.distance_m.rmse);
  CHECK(report["prediction"]["innovations"]["mean_squared"] == result.prediction.innovations->mean);
  CHECK(report["prediction"]["heading_rad"]["count"] == result.prediction.heading_rad.count);
  CHECK(report["prediction"]["heading_innovations"]["mean_squared"] ==
        result.prediction.heading_innovations->mean);
  CHECK(report["prediction"]["wheel_speed_mps"].is_null());
  CHECK(report["fix_flags"]["first"] == 1);
  CHECK(report["times_real_time"] == Approx(result.duration_s / 2.0));
}

TEST_CASE("values without a truth are null in JSON and explained in the text") {
  recording::SensorLog log = sample_log("walk", 2.0);
  log.truth.clear();
  const auto result = evaluation::run(log, {});
  const json report = json::parse(evaluation::report_json(result, {}));
  for (const char* field : {"position_rmse_m", "position_p95_m", "position_max_m", "yaw_rmse_deg",
                            "tilt_rmse_deg", "velocity_rmse_mps", "last_fix_rmse_m", "extrapolated_rmse_m"}) {
    CAPTURE(field);
    REQUIRE(report.contains(field));
    CHECK(report[field].is_null());
  }
  CHECK_THAT(evaluation::report_text(result, {}), Contains("the recording has no truth") && !Contains("nan"));
}

TEST_CASE("a run whose fixes are all doubted says so, and warnings are in both reports") {
  auto log = sample_log("walk");
  for (Event& event : log.events) {
    if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->position_world_m = {1, 2, 0.5};
  }
  const auto result = evaluation::run(log, {.after_s = 6.0});
  const std::string text = evaluation::report_text(result, {});
  CHECK_THAT(text, !Contains("nan") && !Contains("reports no covariance"));
  CHECK_THAT(text, Contains("frozen track"));
  const json report = json::parse(evaluation::report_json(result, {}));
  CHECK(report["warnings"]["frozen_track"] > 0.5);
  CHECK(report["warnings"]["imu_gap"] == 0.0);
}

TEST_CASE("poses before the first used fix are among the warnings") {
  auto log = sample_log("walk");
  std::erase_if(log.events, [&](const Event& event) {
    return std::holds_alternative<UltrasonicFix>(event) &&
           seconds_between(available_at_ns(log.events.front()), available_at_ns(event)) < 5.0;
  });
  const auto result = evaluation::run(log, {});
  const json report = json::parse(evaluation::report_json(result, {}));
  CHECK(report["warnings"]["initialising"] == Approx(5.0 / result.duration_s).margin(0.05));
  CHECK_THAT(evaluation::report_text(result, {}), Contains("% initialising"));
}

TEST_CASE("the text report contains scores with units, counts and the hash") {
  const auto result = evaluation::run(sample_log("outlier_bursts"), {.after_s = 6.0});
  const std::string text = evaluation::report_text(result, {0.01, 0.03});
  CHECK_THAT(text,
             Contains("m RMSE") && Contains("m/s RMSE") && Contains("deg RMSE") && Contains("last fix"));
  CHECK_THAT(text, Contains(" used, ") && Contains(" of them down-weighted, ") && Contains(" rejected ("));
  CHECK_THAT(text, Contains("outlier") && Contains("of the used ones: 1 stale_recovered, 1 first"));
  CHECK_THAT(text, Contains("m RMS from pose to fix") && Contains("% gated") && Contains("deg RMS,"));
  CHECK_THAT(text, Contains("x real time") && Contains(result.state_hash));
}

TEST_CASE("without a true velocity only that figure is unknown") {
  recording::SensorLog log = sample_log("walk", 2.0);
  for (TruthSample& truth : log.truth) truth.velocity_world_mps.setConstant(std::nan(""));
  const std::string text = evaluation::report_text(evaluation::run(log, {}), {});
  CHECK_THAT(text, Contains("not known") && Contains("m RMSE") && !Contains("nan"));
}

TEST_CASE("times without a fix are told from fixes without a pose") {
  recording::SensorLog log = sample_log("walk", 2.0);
  log.truth.clear();
  CHECK_THAT(evaluation::report_text(evaluation::run(log, {.after_s = 100.0}), {}),
             Contains("no fix in the scored time"));
}

}  // namespace report_test
