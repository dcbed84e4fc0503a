/// Accuracy of the fusion on the simulator's scenarios with the default settings, and correctness of the
/// evaluation itself.

#include "evaluation/replay/evaluation.hpp"

#include "evaluation/report/summary_report.hpp"
#include "support/events.hpp"
#include "support/recordings.hpp"
#include "support/seeds.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace evaluation_test {

using namespace sonopose;
using evaluation::CaseResult;

/// Settings with the documented engine.
settings::Settings documented() {
  settings::Settings settings;
  settings.engine.engine = settings::EngineKind::documented;
  return settings;
}

std::vector<CaseResult> runs_of(const std::string& scenario, std::uint64_t seeds = 5,
                                const settings::Settings& settings = documented()) {
  std::vector<CaseResult> runs;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    runs.push_back(
        evaluation::evaluate(evaluation::simulated_case(sim::find_scenario(scenario), seed), settings));
  }
  return runs;
}

/// A body at rest whose fixes are all offset along X.
evaluation::Case standing(double fix_offset_m) {
  evaluation::Case standing = evaluation::simulated_case(sim::find_scenario("rest"), 1);
  for (auto* fix : test::each<UltrasonicFix>(standing.events)) fix->position_world_m.x() += fix_offset_m;
  return standing;
}

/// The rows of a table with this case alone.
std::string row_of(const evaluation::Case& test_case) {
  evaluation::SummaryTable table(10);
  return table.add(evaluation::summarise({evaluation::evaluate(test_case, {})}));
}

TEST_CASE("what the truth does not say is not known, with the reason") {
  evaluation::Case test_case = standing(0.0);
  SECTION("a truth of another time: the prediction errors count") {
    for (TruthSample& truth : test_case.truth) truth.time_ns += to_ns(3600.0);
    const CaseResult result = evaluation::evaluate(test_case, {});
    CHECK_FALSE(result.has_truth);
    CHECK(std::isfinite(*evaluation::cost_of({result}, {result})));
    CHECK_THAT(row_of(test_case), Catch::Contains("no true position at the time of any of its ") &&
                                      Catch::Contains(" poses; its prediction errors follow"));
  }
  SECTION("a truth of positions only: yaw, tilt and velocity are unknown") {
    for (TruthSample& truth : test_case.truth) {
      truth.q_body_to_world.coeffs().setConstant(std::numeric_limits<double>::quiet_NaN());
      truth.velocity_world_mps.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    CHECK_THAT(row_of(test_case), Catch::Contains("–") && !Catch::Contains("inf"));
  }
  SECTION("no pose after the start: nothing is scored") {
    test_case.score_after_s = 1e6;
    CHECK_THAT(row_of(test_case), Catch::Contains("no pose after the start is scored"));
  }
}

TEST_CASE("with the default settings the position error stays within the documented limits", "[accuracy]") {
  const std::map<std::string, double> limits_m{
      {"rest", 0.025},  {"walk", 0.025},          {"forklift", 0.025},
      {"drone", 0.025}, {"low_quality", 0.035},   {"no_heading", 0.035},
      {"kart", 0.04},   {"outlier_bursts", 0.06}, {"spin", 0.06}};
  for (const auto& [scenario, limit_m] : limits_m) {
    const auto summary = evaluation::summarise(runs_of(scenario, test::seeds(3, 5)));
    INFO(scenario << ": " << summary.position_rmse_m << " m, median of " << summary.runs);
    CHECK(summary.position_rmse_m < limit_m);
    CHECK(summary.position_rmse_m < summary.extrapolated_rmse_m);
    CHECK(summary.position_rmse_m < summary.last_fix_rmse_m);
  }
}

TEST_CASE("in a hall with spikes, poor fixes and gaps the pose is not lost") {
  std::vector<double> rmse_m;
  for (std::uint64_t seed = 801; seed <= 809; ++seed) {
    const auto found =
        evaluation::evaluate(evaluation::simulated_case(sim::find_scenario("hall"), seed), documented())
            .clear;
    INFO("seed " << seed << ": " << found.rmse_m << " m, lost for " << found.lost_s << " s");
    CHECK(found.lost_s < 2.0);
    rmse_m.push_back(found.rmse_m);
  }
  std::sort(rmse_m.begin(), rmse_m.end());
  CHECK(rmse_m[rmse_m.size() / 2] < 0.15);
}

TEST_CASE("short wrong tracks and hard stops cost little") {
  const auto median_m = [](const std::string& scenario, const std::string& path) {
    sim::Scenario varied = sim::find_scenario(scenario);
    if (!path.empty()) varied.path = sim::find_scenario(path).path;
    std::vector<CaseResult> runs;
    for (std::uint64_t seed = 801; seed <= 809; ++seed) {
      runs.push_back(evaluation::evaluate(evaluation::simulated_case(varied, seed), documented()));
    }
    return evaluation::summarise(runs).position_rmse_m;
  };
  for (const std::string path : {"walk", "forklift", "kart", "circle", "drone"}) {
    INFO(path);
    CHECK(median_m("short_tracks", path) < 0.06);
  }
  CHECK(median_m("hard_stops", "") < 0.03);
}

TEST_CASE(
    "after an outage the pose recovers within 3 s, and it drifts no farther than the stale rule allows") {
  const settings::Settings settings;
  for (const CaseResult& run : runs_of("outages")) {
    REQUIRE(run.outages.size() == 3);
    for (const evaluation::OutageResult& outage : run.outages) {
      INFO("an outage of " << outage.duration_s << " s");
      CHECK(outage.recovery_s < 3.0);
      // The remaining drift offset is applied meanwhile: a few additional centimetres.
      CHECK(outage.drift_m < outage.drift_allowed_m + 0.1);
      CHECK(outage.drift_allowed_m < 2.0 / settings.outage.velocity_decay_rate_hz);
    }
  }
}

TEST_CASE("the pose follows a relocation within the fixes of item 19 and the decay") {
  const settings::Settings settings;
  for (const CaseResult& run : runs_of("relocation")) {
    REQUIRE(run.relocations.size() == 1);
    constexpr double slowest_fixes_hz = 8.0;
    const double decay_s = 3.0 / settings.drift.decay_rate_hz;
    CHECK(run.relocations[0].distance_m == Approx(2.5));
    CHECK(run.relocations[0].settled_s < settings.trust.n_max / slowest_fixes_hz + decay_s);
  }
}

TEST_CASE("recorded flights: the position error is below 2 cm, and below 4 cm with the documented engine") {
  const std::filesystem::path folder = test::beacon_recordings();
  if (!test::is_here(folder)) return;
  const auto recordings = evaluation::recordings_in(folder).folders;
  CHECK(recordings.size() >= 3);
  const bool is_documented = GENERATE(true, false);
  const settings::Settings settings = is_documented ? documented() : settings::Settings{};
  for (const auto& recording : recordings) {
    const CaseResult result = evaluation::evaluate(evaluation::recorded_case({recording}), settings);
    INFO(result.name << (is_documented ? ", documented" : ", Kalman"));
    CHECK(result.prediction.fixes.size() > 400);
    if (!is_documented) CHECK(result.prediction.distance_p50_m < 0.05);
    if (!result.has_truth) continue;
    CHECK(result.fused.position_m.rmse < (is_documented ? 0.04 : 0.02));
    CHECK(result.fused.position_m.rmse < 0.5 * result.last_fix_m.rmse);
  }
}

TEST_CASE("a case of which no fix is used has a reason instead of a cost") {
  evaluation::Case far = standing(0.0);
  for (auto* fix : test::each<UltrasonicFix>(far.events)) fix->position_world_m.x() += 5e6;  // as in UTM
  evaluation::Case without = standing(0.0);
  std::erase_if(without.events,
                [](const Event& event) { return std::holds_alternative<UltrasonicFix>(event); });
  const evaluation::CostFunction cost({{standing(0.0)}, {far}, {without}}, {});
  REQUIRE(cost.left_out().size() == 2);
  CHECK_THAT(cost.left_out()[0], Catch::Contains("no fix was used") &&
                                     Catch::Contains("a coordinate is above admission.max_position_m"));
  CHECK_THAT(cost.left_out()[1], Catch::Contains("has no fix"));
  CHECK(evaluation::evaluate(standing(0.0), {}).fix_fault.empty());
}

TEST_CASE("an offset of 10 cm of all fixes gives an error of 10 cm, in the pose and in the last fix") {
  const CaseResult right = evaluation::evaluate(standing(0.0), {});
  const CaseResult aside = evaluation::evaluate(standing(0.1), {});
  CHECK(aside.fused.position_m.rmse == Approx(std::hypot(0.1, right.fused.position_m.rmse)).margin(0.005));
  CHECK(aside.last_fix_m.rmse == Approx(std::hypot(0.1, right.last_fix_m.rmse)).margin(0.005));
}

TEST_CASE("the last fix lags by its delay and half an interval, the extrapolated fix does not") {
  // 6 m/s on the circle, 68 ms of delay, and about 50 ms until the next fix.
  const CaseResult run = runs_of("circle", 1).front();
  CHECK(run.last_fix_m.rmse > 6.0 * 0.08);
  CHECK(run.last_fix_m.rmse < 6.0 * 0.18);
  CHECK(run.extrapolated_m.rmse < 0.3 * run.last_fix_m.rmse);
}

TEST_CASE("runs are summarised by their median and worst error; NaN counts as the worst") {
  std::vector<CaseResult> runs(3);
  const std::array errors_m{0.05, std::nan(""), 0.02};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].name = "case";
    runs[i].has_truth = true;
    runs[i].fused.position_m.rmse = errors_m[i];
  }
  const auto summary = evaluation::summarise(runs);
  CHECK(summary.position_rmse_m == 0.05);
  CHECK(std::isinf(summary.worst_rmse_m));
  CHECK_FALSE(summary.slowest_recovery_s.has_value());
  runs[0].outages = {{2.0, 1.5, 0.4, 0.8}, {4.0, 0.7, 0.9, 0.8}};
  CHECK(evaluation::summarise(runs).slowest_recovery_s == 1.5);
  CHECK(*evaluation::summarise(runs).worst_drift_share == Approx(0.9 / 0.8));
  evaluation::SummaryTable table(4);
  const std::string first = table.add(summary);
  CHECK_THAT(first, Catch::Matchers::Contains("recovery") && Catch::Matchers::Contains("5.00"));
  CHECK_THAT(table.add(summary), !Catch::Contains("recovery") && Catch::Matchers::Contains("5.00"));
  CHECK_THAT(evaluation::json_of({summary}), Catch::Matchers::Contains("\"position_rmse_m\": 0.05"));
}

SCENARIO("a case without truth is scored by its prediction errors") {
  evaluation::Case walk = evaluation::simulated_case(sim::find_scenario("walk"), 1);
  const CaseResult with_truth = evaluation::evaluate(walk, {});
  for (TruthSample& truth : walk.truth) truth.position_world_m.setConstant(std::nan(""));
  const CaseResult result = evaluation::evaluate(walk, {});
  CHECK_FALSE(result.has_truth);
  CHECK(std::isnan(result.fused.position_m.rmse));
  CHECK(result.prediction.distance_m.rmse == with_truth.prediction.distance_m.rmse);
  CHECK(evaluation::cost_of({result}, {result}) ==
        Approx(result.prediction.distance_m.rmse).epsilon(1e-12));  // all fixes are trusted
  CHECK(evaluation::cost_of({with_truth}, {with_truth}) == Approx(with_truth.fused.position_m.rmse));
  const auto summary = evaluation::summarise({result});
  evaluation::SummaryTable table(4);
  const std::string row_above = table.add(summary);
  CHECK_THAT(row_above + table.predictions(),
             !Catch::Contains("nan") && !Catch::Contains("inf") && Catch::Contains("no truth"));
  const auto row = nlohmann::json::parse(evaluation::json_of({summary})).at(0);
  CHECK(row.at("position_rmse_m").is_null());
  CHECK(row.at("prediction").at(0).at("distance_rms_m").get<double>() == result.prediction.distance_m.rmse);
}

SCENARIO("each row of a table is printed at once, the first below the header") {
  evaluation::Case with_truth = standing(0.0);
  evaluation::Case without = with_truth;
  without.truth.clear();
  with_truth.name = "driven";
  without.name = "filmed";
  const auto summary_of = [](const evaluation::Case& each) {
    return evaluation::summarise({evaluation::evaluate(each, {})});
  };
  evaluation::SummaryTable table(6);
  std::string printed;
  for (const evaluation::Case& each : {without, with_truth, without}) {
    const std::string row = table.add(summary_of(each));
    CHECK_THAT(row, Catch::Contains(each.name));  // a later case may fail
    printed += row;
  }
  printed += table.predictions();
  const std::size_t header = printed.find("recovery");
  REQUIRE(header != std::string::npos);
  CHECK(header < printed.find("filmed"));
  CHECK(printed.find("filmed") < printed.find("driven"));
  CHECK(printed.find("driven") < printed.find("filmed", printed.find("driven")));
  CHECK(printed.find("\nprediction ") > printed.find("filmed", printed.find("driven")));
}

SCENARIO("settings that follow wrong tracks cost more, also without truth") {
  std::vector<std::vector<evaluation::Case>> cases{
      {evaluation::simulated_case(sim::find_scenario("outlier_bursts"), 801)}};
  cases.front().front().truth.clear();
  const evaluation::CostFunction cost(std::move(cases), documented());
  settings::Settings credulous = documented();
  credulous.trust.enabled = false;
  CHECK_FALSE(cost.has_truth_of_all());
  CHECK(cost(credulous) > 1.2 * cost(documented()));
}

SCENARIO("a case that ends before the score begins is left out of a cost") {
  evaluation::Case brief = evaluation::simulated_case(sim::find_scenario("walk"), 1);
  brief.score_after_s = 1000.0;
  const evaluation::CostFunction cost({{brief}}, {});
  CHECK(cost.empty());
  REQUIRE(cost.left_out().size() == 1);
  CHECK(cost.left_out().front() == "walk: nothing to score after 1000 s");
}

}  // namespace evaluation_test
