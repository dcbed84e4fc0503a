// sonopose-tune: searches for settings with a lower error on scenarios and recordings.

#include "evaluation/evaluation.hpp"
#include "evaluation/search.hpp"
#include "recording/log_folder.hpp"
#include "support/case_options.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <string>
#include <unistd.h>
#include <utility>
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

volatile std::sig_atomic_t interrupted = 0;

/// The first Ctrl-C ends the search after the current round, the second one the program.
void listen_for_interrupt() {
  std::signal(SIGINT, [](int signal) {
    interrupted = 1;
    std::signal(signal, SIG_DFL);
  });
}

/// Shows the round on a terminal, in one line.
void show_progress(int round, int rounds, double best_m) {
  if (::isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\rround {} of {}, best {:.3f} cm ", round + 1, rounds, 100.0 * best_m);
}

/// The settings that differ between the two, as the beacon needs them.
config::FusionConfig changes(const config::FusionConfig& before, const settings::Settings& found,
                             const std::vector<evaluation::Variable>& variables, BeaconAddress beacon) {
  config::FusionConfig changed = before;
  config::FusionConfig only;
  for (const evaluation::Variable& variable : variables) {
    const auto value = settings::get(found, variable.key);
    if (value == settings::get(before.for_beacon(beacon), variable.key)) continue;
    const std::string text = variable.key + "=" + settings::to_text(value);
    changed.assign(text);
    only.assign(text);
    const bool overruled = settings::get(changed.for_beacon(beacon), variable.key) != value;
    if (overruled) only.assign(fmt::format("beacon.{}.{}", beacon, text));
  }
  return only;
}

int tune(const CLI::App& app, const Options& options) {
  const config::FusionConfig config = apps::configuration(app, options.config);
  const settings::Settings start = config.for_beacon(options.beacon);
  std::vector<evaluation::Variable> variables;
  for (const std::string& text : options.vary) variables.push_back(evaluation::variable_of(text));
  check_read(variables, start);
  std::vector<std::vector<evaluation::Case>> cases;
  bool all_with_truth = true;
  apps::for_each_case(options.cases, [&](std::vector<evaluation::Case> runs) {
    all_with_truth = all_with_truth && !runs.front().truth.empty();
    cases.push_back(std::move(runs));
  });

  const double start_m = evaluation::cost_of(cases, start);
  double best_m = start_m;
  listen_for_interrupt();
  const auto found = evaluation::search(
      start, variables,
      [&](const settings::Settings& settings) { return evaluation::cost_of(cases, settings); },
      options.rounds, options.search_seed,
      [&best_m](int round, const evaluation::Found& better) {
        best_m = better.cost;
        fmt::print(stderr, "{}round {}: {:.3f} cm\n", ::isatty(STDERR_FILENO) != 0 ? "\r" : "", round + 1,
                   100.0 * better.cost);
      },
      [&](int round) {
        if (interrupted != 0) {
          fmt::print(stderr, "\ninterrupted after {} rounds of {}: the best so far follows\n", round,
                     options.rounds);
          return false;
        }
        show_progress(round, options.rounds, best_m);
        return true;
      });
  fmt::print("# Geometric mean over the cases: {:.3f} cm, before {:.3f} cm.{}\n{}", 100.0 * found.cost,
             100.0 * start_m,
             all_with_truth ? "" : " Cases without truth count with their prediction errors.",
             changes(config, found.settings, variables, options.beacon).given_toml());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("tune",
                    "It prints what it changed as a TOML file; Ctrl-C ends the search and prints the best so "
                    "far. A case without "
                    "truth counts with its prediction errors. To search items 2, 3 and 4, add --set "
                    "fusion.imu_weight=user.");
  add_options(app, options);
  return apps::run(app, argc, argv, [&] { return tune(app, options); });
}
