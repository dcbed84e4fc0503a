// sonopose-evaluate: how the fusion does on every scenario of the simulator, and on recordings with truth.

#include "support/config_options.hpp"
#include "support/run.hpp"
#include <sonopose/replay/evaluation.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  apps::ConfigOptions config;
  std::vector<std::string> scenarios;
  std::optional<std::filesystem::path> recordings;
  std::uint64_t seeds = 5;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("SCENARIO", options.scenarios, "Which scenarios (default: all)")->type_name("");
  apps::add_config_options(app, options.config);
  app.add_option("--seeds", options.seeds, "Runs of each scenario")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--recordings", options.recordings, "Also every sensor-log folder with truth in this one")
      ->type_name("DIR")
      ->envname("SONOPOSE_RECORDINGS");
  app.add_flag("--json", options.json, "A JSON array instead of the table");
}

std::vector<const sim::Scenario*> scenarios_of(const Options& options) {
  std::vector<const sim::Scenario*> chosen;
  for (const std::string& name : options.scenarios) chosen.push_back(&sim::find_scenario(name));
  if (!chosen.empty()) return chosen;
  for (const sim::Scenario& scenario : sim::scenarios()) chosen.push_back(&scenario);
  return chosen;
}

int evaluate(const CLI::App& app, const Options& options) {
  const fusion::Settings settings = apps::configuration(app, options.config).for_beacon(all_beacons);
  std::vector<replay::Summary> summaries;
  for (const sim::Scenario* scenario : scenarios_of(options)) {
    std::vector<replay::CaseResult> runs;
    for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
      runs.push_back(replay::evaluate(replay::simulated_case(*scenario, seed), settings));
    }
    summaries.push_back(replay::summarise(runs));
  }
  if (options.recordings) {
    for (const std::filesystem::path& folder : replay::recordings_with_truth(*options.recordings)) {
      summaries.push_back(replay::summarise({replay::evaluate(replay::recorded_case(folder), settings)}));
    }
  }
  fmt::print("{}", options.json ? replay::json_of(summaries) : replay::table_of(summaries));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Scores the fused pose on the simulator's scenarios and on recordings with truth, beside the latest "
      "fix "
      "and the latest fix carried on at its velocity.",
      "sonopose-evaluate");
  add_options(app, options);
  return apps::run(app, argc, argv, [&] { return evaluate(app, options); });
}
