// sonopose-evaluate: scores the fusion on the scenarios of the simulator and on recordings with truth.

#include "recording/log_folder.hpp"
#include "support/case_options.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <vector>

namespace {

using namespace sonopose;

struct Options {
  apps::ConfigOptions config;
  apps::CaseOptions cases;
  BeaconAddress beacon = recording::default_log_address;
  std::vector<std::string> engines;  ///< empty: that of the settings
  bool json = false;
};

/// One for each engine.
std::vector<settings::Settings> settings_of(const CLI::App& app, const Options& options) {
  if (options.engines.empty()) return {apps::configuration(app, options.config).for_beacon(options.beacon)};
  std::vector<settings::Settings> all;
  for (const std::string& engine : options.engines) {
    apps::ConfigOptions config = options.config;
    apps::assign_everywhere(config, options.beacon, "fusion.engine", engine);
    all.push_back(apps::configuration(app, config).for_beacon(options.beacon));
  }
  return all;
}

int evaluate(const CLI::App& app, const Options& options) {
  const std::vector<settings::Settings> engines = settings_of(app, options);
  std::vector<evaluation::Summary> summaries;
  apps::for_each_case(options.cases, [&](const std::vector<evaluation::Case>& runs) {
    for (const settings::Settings& settings : engines) {
      std::vector<evaluation::CaseResult> results;
      results.reserve(runs.size());
      for (const evaluation::Case& run : runs) results.push_back(evaluation::evaluate(run, settings));
      summaries.push_back(evaluation::summarise(results));
    }
  });
  fmt::print("{}", options.json ? evaluation::json_of(summaries) : evaluation::table_of(summaries));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app(
      "evaluate",
      "For comparison it also scores the latest fix, and the latest fix extrapolated at its velocity.");
  apps::add_case_options(app, options.cases);
  apps::add_config_options(app, options.config);
  apps::add_beacon_option(app, options.beacon);
  app.add_option("--engine", options.engines,
                 "Engines to score, each in rows of its own, instead of fusion.engine")
      ->check(CLI::IsMember({"documented", "kalman"}));
  app.add_flag("--json", options.json, "Print a JSON array instead of the table");
  return apps::run(app, argc, argv, [&] { return evaluate(app, options); });
}
