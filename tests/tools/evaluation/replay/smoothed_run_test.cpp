#include "evaluation/replay/smoothed_run.hpp"

#include "evaluation/report/report.hpp"
#include "evaluation/sample_log.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace smoothed_run_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

struct Outputs {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;

  [[nodiscard]] evaluation::Observer observer() {
    return {[this](const FusedPose& pose) { poses.push_back(pose); },
            [this](const FixReport& report) { reports.push_back(report); }};
  }
};

SCENARIO("a smoothed run has the smoothed poses and the engine's reports") {
  GIVEN("a walk with a wrong track, with the engine's own outputs") {
    const recording::SensorLog log = sample_log("outlier_bursts");
    Outputs plain;
    const auto engine = evaluation::run(log, {.after_s = 6.0}, plain.observer());
    WHEN("it is smoothed") {
      Outputs smoothed;
      const auto result = evaluation::run_smoothed(log, {.after_s = 6.0}, smoothed.observer());
      THEN("reports, counters and hash are the engine's, and its score is beside that of the smoother") {
        CHECK(smoothed.reports == plain.reports);
        CHECK(result.state_hash == engine.state_hash);
        CHECK(result.counters.fixes_used == engine.counters.fixes_used);
        REQUIRE(result.smoothing);
        CHECK(result.smoothing->engine.position_m.rmse == engine.fused.position_m.rmse);
        CHECK(result.fused.position_m.rmse < engine.fused.position_m.rmse);
        CHECK(result.fused.poses == engine.fused.poses);
      }
      THEN("each pose is of one of the samples, in their order, and no bit says that it starts") {
        REQUIRE(smoothed.poses.size() == result.poses);
        CHECK(smoothed.poses.size() == plain.poses.size());
        for (std::size_t i = 0; i < smoothed.poses.size(); ++i) {
          CHECK(smoothed.poses[i].sequence == plain.poses[i].sequence);
          CHECK((smoothed.poses[i].status & (status_initialising | status_converging)) == 0);
          CHECK(smoothed.poses[i].pose_covariance.std_dev(0) > 0.0);
        }
      }
    }
    WHEN("only its first ten seconds are smoothed") {
      const auto result = evaluation::run_smoothed(log, {.after_s = 6.0, .until_s = 10.0});
      THEN("there are the poses of ten seconds") {
        CHECK(result.poses == Approx(1000).margin(2));
      }
    }
  }
}

SCENARIO("the ratio of smoothed and unsmoothed errors is over the same poses") {
  GIVEN("a walk whose fixes begin after five seconds") {
    recording::SensorLog log = sample_log("walk", 20.0);
    const TimeNs begin_ns = available_at_ns(log.events.front());
    std::erase_if(log.events, [begin_ns](const Event& event) {
      return !std::holds_alternative<ImuSample>(event) &&
             seconds_between(begin_ns, available_at_ns(event)) < 5.0;
    });
    WHEN("it is smoothed and scored from the start") {
      const auto result = evaluation::run_smoothed(log, {});
      THEN("the engine is scored only where there is a smoothed pose") {
        REQUIRE(result.smoothing);
        CHECK(result.fused.poses < 1700);
        CHECK(result.smoothing->engine.times_ns == result.fused.times_ns);
      }
    }
  }
}

SCENARIO("a recording without truth is smoothed as well") {
  GIVEN("a walk without truth") {
    recording::SensorLog log = sample_log("walk", 5.0);
    log.truth.clear();
    const auto result = evaluation::run_smoothed(log, {});
    THEN("there are poses, and the report has no ratio") {
      CHECK(result.poses > 400);
      CHECK_THAT(evaluation::report_text(result, {}), Contains("noise") && !Contains("nan"));
      CHECK_THAT(evaluation::report_json(result, {}), Contains("\"position_ratio\": null"));
    }
  }
}

SCENARIO("what cannot be smoothed is refused with the reason") {
  GIVEN("a recording") {
    const recording::SensorLog log = sample_log("walk", 2.0);
    THEN("another engine, a saved state and an estimated delay are refused") {
      evaluation::RunOptions documented;
      documented.settings.engine.engine = settings::EngineKind::documented;
      CHECK_THROWS_WITH(evaluation::run_smoothed(log, documented), Contains("Kalman"));
      evaluation::RunOptions continued;
      continued.start = evaluation::run(log, {}).end;
      CHECK_THROWS_WITH(evaluation::run_smoothed(log, continued), Contains("saved state"));
      evaluation::RunOptions with_delay;
      with_delay.settings.delay.estimate = true;
      CHECK_THROWS_WITH(evaluation::run_smoothed(log, with_delay), Contains("kalman.delay.estimate"));
      evaluation::RunOptions planar;
      planar.settings.planar.planar = true;
      CHECK_THROWS_WITH(evaluation::run_smoothed(log, planar), Contains("motion.planar"));
    }
  }
}

}  // namespace smoothed_run_test
