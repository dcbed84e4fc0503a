/// Accuracy of the Kalman engine with the default settings. No parameter was chosen on the seeds 4001 to
/// 4009; the seeds of the last scenario once lost the pose.

#include "evaluation/replay/evaluation.hpp"
#include "support/seeds.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace kalman_accuracy_test {

using namespace sonopose;
using evaluation::CaseResult;

std::vector<evaluation::Case> cases_of(const sim::Scenario& scenario, unsigned few) {
  std::vector<evaluation::Case> runs;
  for (unsigned i = 0; i < test::seeds(few, 9); ++i) {
    runs.push_back(evaluation::simulated_case(scenario, 4001 + i));
  }
  return runs;
}

/// A requirement of the project (docs/accuracy.md, "Accuracy"). The bars are not derived from the noise.
struct Bar {
  std::string scenario;
  double position_m;
  double yaw_deg = 1.0;
};

TEST_CASE("the median error of the Kalman engine is below the bar of each scenario", "[accuracy]") {
  const std::vector<Bar> bars{{"rest", 0.010},        {"walk", 0.016},        {"circle", 0.016},
                              {"forklift", 0.016},    {"kart", 0.016},        {"jitter", 0.016},
                              {"drone", 0.017},       {"spin", 0.016},        {"outlier_bursts", 0.021},
                              {"low_quality", 0.021}, {"packet_loss", 0.021}, {"gyro_bias", 0.022},
                              {"relocation", 0.40},   {"outages", 0.12},      {"no_heading", 0.017, 1.5}};
  for (const Bar& bar : bars) {
    const auto summary =
        evaluation::summarise(evaluation::evaluate_all(cases_of(sim::find_scenario(bar.scenario), 5), {}));
    INFO(bar.scenario << ": " << summary.position_rmse_m << " m, " << summary.yaw_rmse_deg << " degrees");
    CHECK(summary.position_rmse_m < bar.position_m);
    CHECK(summary.yaw_rmse_deg < bar.yaw_deg);
  }
}

TEST_CASE("outages of the fixes cost the Kalman engine little and are soon over", "[accuracy]") {
  constexpr double again_good_s = 0.3;
  constexpr double looked_at_s = 0.5;
  double squares = 0.0;
  const auto runs = cases_of(sim::find_scenario("outages"), 5);
  for (const evaluation::Case& run : runs) {
    const CaseResult result = evaluation::evaluate(run, {});
    squares += result.fused.position_m.rmse * result.fused.position_m.rmse;
    CHECK(result.fused.position_m.max < 1.1);
    const TimeNs start_ns = available_at_ns(run.events.front());
    for (const sim::Outage& outage : run.outages) {
      const double from_s = outage.begin_s + outage.duration_s + again_good_s;
      std::vector<double> errors_m;
      for (std::size_t i = 0; i < result.fused.errors_m.size(); ++i) {
        const double since_s = seconds_between(start_ns, result.fused.times_ns[i]) - from_s;
        if (since_s >= 0.0 && since_s < looked_at_s) errors_m.push_back(result.fused.errors_m[i]);
      }
      INFO("after an outage of " << outage.duration_s << " s");
      CHECK(evaluation::error_summary_of(errors_m).rmse < evaluation::recovered_m);
    }
  }
  CHECK(std::sqrt(squares / static_cast<double>(runs.size())) < 0.12);
}

TEST_CASE("where good fixes come, the Kalman engine is not lost", "[accuracy]") {
  for (const sim::Scenario& scenario : sim::harder_scenarios()) {
    const auto summary = evaluation::summarise(evaluation::evaluate_all(cases_of(scenario, 3), {}));
    INFO(scenario.name << ": lost for " << summary.lost_s << " s");
    CHECK(summary.lost_s < 3.0);
  }
}

SCENARIO("a wrong track that the Kalman engine followed for a moment does not keep it lost") {
  // The engine once lost each of these for more than three seconds.
  const std::uint64_t seed = GENERATE(1310035U, 1310110U, 1810083U, 1310429U);
  GIVEN("drifting tracks of the seed " << seed) {
    const auto run = evaluation::simulated_case(sim::find_scenario("drifting_tracks"), seed);
    const auto summary = evaluation::summarise(evaluation::evaluate_all({run}, {}));
    THEN("it is lost for less than two and a half seconds where good fixes come") {
      CHECK(summary.lost_s < 2.5);
    }
  }
}

}  // namespace kalman_accuracy_test
