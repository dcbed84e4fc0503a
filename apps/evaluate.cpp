// sonopose-evaluate: scores the fusion on the scenarios of the simulator and on recordings.

#include "evaluation/report/side_by_side.hpp"
#include "evaluation/report/summary_report.hpp"
#include "logging/log.hpp"
#include "support/case_options.hpp"
#include "support/config_options.hpp"
#include "support/progress.hpp"
#include "support/run.hpp"
#include "support/waiting.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  apps::ConfigOptions config;
  apps::CaseOptions cases;
  std::vector<std::string> engines;             ///< names; empty: the engine of the settings
  std::vector<std::filesystem::path> compared;  ///< two files of settings, or none
  bool json = false;
};

/// Returns the settings of each engine.
std::vector<settings::Settings> settings_of(const Options& options) {
  if (options.engines.empty())
    return {apps::settings_of(apps::configuration(options.config), options.cases.beacon)};
  std::vector<settings::Settings> all;
  for (const std::string& engine : options.engines) {
    apps::ConfigOptions config = options.config;
    config.chosen.push_back({"fusion.engine", engine, options.cases.beacon});
    const config::FusionConfig read = apps::configuration(config);
    const BeaconAddress beacon = options.cases.beacon;
    all.push_back(all.empty() ? apps::settings_of(read, beacon) : read.for_beacon(beacon));  // warns once
  }
  return all;
}

/// Returns the settings of one of the compared files; --set applies to both.
settings::Settings settings_of(const Options& options, const std::filesystem::path& file) {
  apps::ConfigOptions config = options.config;
  config.file = file;
  return apps::settings_of(apps::configuration(config), options.cases.beacon);
}

void show(const apps::CasePlace& place, apps::Progress& progress) {
  progress.at(static_cast<double>(place.index) / static_cast<double>(place.count),
              fmt::format("case {} of {}: {}", place.index + 1, place.count, place.name));
}

int compare(const Options& options) {
  const std::filesystem::path& first = options.compared[0];
  const std::filesystem::path& second = options.compared[1];
  const settings::Settings first_settings = settings_of(options, first);
  const settings::Settings second_settings = settings_of(options, second);
  std::vector<evaluation::CostPair> costs;
  apps::Progress progress;
  const auto compare_case = [&](const std::vector<evaluation::Case>& runs) {
    const auto first_results = evaluation::evaluate_all(runs, first_settings);
    const auto is_scored = [&](const std::optional<double>& cost_m, const std::filesystem::path& settings) {
      if (cost_m && std::isfinite(*cost_m)) return true;
      progress.clear();
      logging::warning(
          fmt::format("left out: {}: nothing to score with {}", runs.front().name, settings.string()));
      return false;
    };
    const auto first_m = evaluation::cost_of(first_results, first_results);
    if (!is_scored(first_m, first)) return;
    // Both costs count the same fixes.
    const auto second_m = evaluation::cost_of(evaluation::evaluate_all(runs, second_settings), first_results);
    if (!is_scored(second_m, second)) return;
    costs.push_back({runs.front().name, first_results.front().has_truth, *first_m, *second_m});
  };
  const std::size_t left_out =
      apps::for_each_case(options.cases, first_settings, compare_case,
                          [&](const apps::CasePlace& place) { show(place, progress); });
  progress.clear();
  if (costs.empty()) throw std::invalid_argument("--compare: no case can be scored");
  apps::print("{}", options.json ? json_of(costs, first.string(), second.string())
                                 : table_of(costs, first.string(), second.string()));
  return left_out == 0 ? 0 : 1;
}

int evaluate(const Options& options) {
  if (!options.compared.empty()) return compare(options);
  const std::vector<settings::Settings> engines = settings_of(options);
  apps::Progress progress;
  std::optional<evaluation::SummaryTable> table;
  bool is_only_case = false;
  std::size_t left_out = 0;
  const auto begin = [&](const apps::CasePlace& place) {
    is_only_case = place.count == 1;
    if (!table) table.emplace(place.name_columns);
    show(place, progress);
  };
  const auto score = [&](const std::vector<evaluation::Case>& runs) {
    for (const settings::Settings& settings : engines) {
      std::optional<apps::Waiting> waiting;  // for several cases, their number shows the progress
      if (is_only_case) waiting.emplace(runs.front().name);
      const auto results = evaluation::evaluate_all(runs, settings);
      waiting.reset();
      progress.clear();
      if (apps::is_left_out(results, left_out)) continue;
      const std::string lines = table->add(evaluation::summarise(results));
      if (!options.json) apps::print("{}", lines);
      apps::flush_output();
    }
  };
  left_out += apps::for_each_case(options.cases, engines.front(), score, begin);
  progress.clear();
  apps::print("{}", options.json ? evaluation::json_of(table->rows()) : table->predictions());
  return left_out == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("evaluate",
                    "It prints the errors against the truth, where there is one, next to those of the latest "
                    "fix and of the "
                    "latest fix extrapolated at its velocity; and for each case the prediction errors, which "
                    "need no truth.");
  apps::add_case_options(app, options.cases);
  apps::add_config_options(app, options.config);
  auto engines = app.add_option("--engine", options.engines,
                                "Engines to score, each in rows of its own, instead of fusion.engine")
                     .check(apps::one_of({"documented", "kalman"}));
  app.add_option(
         "--compare", options.compared,
         "Put two files of settings side by side: the error of each case, or its prediction error if it "
         "has no truth")
      .expected(2)
      .allow_extra_args(false)
      .type_name("FILE FILE")
      .excludes(engines)
      .excludes(app.option("--config"));
  app.add_flag("--json", options.json, "Print JSON instead of tables");
  return apps::run(app, argc, argv, [&] { return evaluate(options); });
}
