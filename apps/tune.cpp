// sonopose-tune: searches for settings with a lower error on scenarios and recordings with truth.

#include "evaluation/search.hpp"
#include "recording/log_folder.hpp"
#include "support/case_options.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  apps::ConfigOptions config;
  apps::CaseOptions cases;
  BeaconAddress beacon = recording::default_log_address;
  std::vector<std::string> vary;
  int rounds = 500;
  std::uint64_t search_seed = 1;
};

void add_options(CLI::App& app, Options& options) {
  apps::add_case_options(app, options.cases);
  apps::add_config_options(app, options.config);
  apps::add_beacon_option(app, options.beacon);
  app.add_option("--vary", options.vary,
                 "Setting to search: GROUP.KEY or GROUP.KEY=LOW..HIGH; may be repeated")
      ->required()
      ->type_name("KEY=LOW..HIGH")
      ->allow_extra_args(false);
  app.add_option("--rounds", options.rounds, "Number of random settings to try")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--search-seed", options.search_seed, "Seed of the search")->capture_default_str();
}

/// Throws ConfigError for a setting that the chosen engine does not read.
void check_read(const std::vector<evaluation::Variable>& variables, const settings::Settings& settings) {
  if (settings.engine.engine == settings::EngineKind::documented) return;
  for (const evaluation::Variable& variable : variables) {
    if (settings::setting_info(variable.key).read_by == settings::ReadBy::all) continue;
    throw config::ConfigError(fmt::format(
        "--vary {}: fusion.engine is {}, and only documented reads it; add --set fusion.engine=documented",
        variable.key, settings::to_text(settings::get(settings, "fusion.engine"))));
  }
}

int tune(const CLI::App& app, const Options& options) {
  config::FusionConfig config = apps::configuration(app, options.config);
  std::vector<evaluation::Variable> variables;
  for (const std::string& text : options.vary) variables.push_back(evaluation::variable_of(text));
  check_read(variables, config.for_beacon(options.beacon));
  std::vector<std::vector<evaluation::Case>> cases;
  apps::for_each_case(options.cases,
                      [&](std::vector<evaluation::Case> runs) { cases.push_back(std::move(runs)); });

  const auto found = evaluation::search(
      config.for_beacon(options.beacon), variables,
      [&](const settings::Settings& settings) { return evaluation::cost_of(cases, settings); },
      options.rounds, options.search_seed,
      [](int round, const evaluation::Found& better) {
        fmt::print(stderr, "round {}: {:.3f} cm\n", round + 1, 100.0 * better.cost);
      });
  for (const evaluation::Variable& variable : variables) {
    const std::string value = settings::to_text(settings::get(found.settings, variable.key));
    config.assign(variable.key + "=" + value);
    const bool overruled = settings::get(config.for_beacon(options.beacon), variable.key) !=
                           settings::get(found.settings, variable.key);
    if (overruled) config.assign(fmt::format("beacon.{}.{}={}", options.beacon, variable.key, value));
  }
  fmt::print("# Geometric mean over the cases: {:.3f} cm.\n{}", 100.0 * found.cost, config.to_toml());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app(
      "tune", "It prints them as a TOML file. To search items 2, 3 and 4, add --set fusion.imu_weight=user.");
  add_options(app, options);
  return apps::run(app, argc, argv, [&] { return tune(app, options); });
}
