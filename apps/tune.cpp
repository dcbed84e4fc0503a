// sonopose-tune: searches for settings with a lower error on scenarios and recordings.

#include "config/beacon_settings.hpp"
#include "evaluation/replay/evaluation.hpp"
#include "evaluation/replay/search.hpp"
#include "logging/log.hpp"
#include "support/case_options.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"
#include "support/search_progress.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  apps::ConfigOptions config;
  apps::CaseOptions cases;
  std::vector<std::string> vary;
  int rounds = 500;
  std::uint64_t search_seed = 1;
};

void add_options(apps::CommandLine& app, Options& options) {
  apps::add_case_options(app, options.cases);
  apps::add_config_options(app, options.config);
  app.add_option("--vary", options.vary,
                 "Setting to search: GROUP.KEY or GROUP.KEY=LOW..HIGH; may be repeated")
      .required()
      .type_name("KEY=LOW..HIGH")
      .allow_extra_args(false);
  app.add_option("--rounds", options.rounds, "Number of random settings to try")
      .check(apps::number_between(1, 1'000'000))
      .capture_default_str();
  app.add_option("--search-seed", options.search_seed, "Seed of the search").capture_default_str();
}

/// Throws ConfigError for a setting that the chosen engine does not read.
void check_read(const std::vector<evaluation::Variable>& variables, const settings::Settings& settings) {
  const bool is_documented = settings.engine.engine == settings::EngineKind::documented;
  const auto unread = is_documented ? settings::ReadBy::kalman : settings::ReadBy::documented;
  const std::string weight = settings::to_text(settings::get(settings, "documented.imu_weight"));
  for (const evaluation::Variable& variable : variables) {
    if (is_documented && weight != "user" && config::is_preset_key(variable.key)) {
      throw config::ConfigError(
          fmt::format("--vary {}: documented.imu_weight = {} sets it; add --set documented.imu_weight=user",
                      variable.key, weight));
    }
    if (settings::setting_info(variable.key).read_by != unread) continue;
    const std::string_view reader = is_documented ? "kalman" : "documented";
    throw config::ConfigError(fmt::format(
        "--vary {}: fusion.engine is {}, and only {} reads it; add --set fusion.engine={}", variable.key,
        settings::to_text(settings::get(settings, "fusion.engine")), reader, reader));
  }
}

/// Returns the cases that can be scored. Reports the others, and counts recordings that were named in vain.
evaluation::CostFunction cost_function(const Options& options, const settings::Settings& start,
                                       std::size_t& left_out) {
  std::vector<std::vector<evaluation::Case>> cases;
  left_out = apps::for_each_case(
      options.cases, start, [&](std::vector<evaluation::Case> runs) { cases.push_back(std::move(runs)); });
  evaluation::CostFunction cost(std::move(cases), start);
  for (const std::string& text : cost.left_out()) logging::warning("left out: " + text);
  if (cost.empty()) throw std::invalid_argument("no case can be scored");
  return cost;
}

/// Returns the settings that differ from `before`: for all beacons, or for this one if its own settings take
/// precedence.
config::FusionConfig changes(const config::FusionConfig& before, const settings::Settings& found,
                             const std::vector<evaluation::Variable>& variables, BeaconAddress beacon) {
  config::FusionConfig only;
  for (const evaluation::Variable& variable : variables) {
    const auto value = settings::get(found, variable.key);
    if (value == settings::get(before.for_beacon(beacon), variable.key)) continue;
    const std::string text = variable.key + "=" + settings::to_text(value);
    config::FusionConfig changed = before;
    changed.assign(text);
    const bool overruled = settings::get(changed.for_beacon(beacon), variable.key) != value;
    only.assign(overruled ? fmt::format("beacon.{}.{}", beacon, text) : text);
  }
  return only;
}

/// Returns the options that the found settings depend on, as a comment.
std::string origin_comment(const apps::ConfigOptions& options) {
  std::string text;
  if (options.file) text += " --config " + options.file->string();
  for (const std::string& assignment : options.assignments) text += " --set " + assignment;
  return text.empty() ? "" : "# To use together with" + text + "\n";
}

int tune(const Options& options) {
  apps::listen_for_interrupt();
  const config::FusionConfig config = apps::configuration(options.config);
  const settings::Settings start = apps::settings_of(config, options.cases.beacon);
  std::vector<evaluation::Variable> variables;
  for (const std::string& text : options.vary) variables.push_back(evaluation::variable_of(text));
  check_read(variables, start);
  std::size_t left_out = 0;
  const evaluation::CostFunction cost = cost_function(options, start, left_out);

  std::optional<double> start_m;
  const auto found = [&] {
    apps::SearchProgress progress(options.rounds);
    const auto cost_and_start = [&](const settings::Settings& settings) {
      const double cost_m = cost(settings);
      if (!start_m) progress.start_at(start_m.emplace(cost_m));
      return cost_m;
    };
    const auto goes_on = [&](int round) {
      apps::interrupted != 0 ? progress.on_interrupt(round) : progress.on_round(round);
      return apps::interrupted == 0;
    };
    return evaluation::search(
        start, variables, cost_and_start, options.rounds, options.search_seed,
        [&](int round, const evaluation::Found& better) { progress.on_better(round, better.cost); }, goes_on);
  }();
  apps::print("# Geometric mean over the cases: {:.3f} cm, before {:.3f} cm.{}\n{}{}", 100.0 * found.cost,
              100.0 * *start_m,
              cost.has_truth_of_all() ? "" : " Cases without truth count with their prediction errors.",
              origin_comment(options.config),
              changes(config, found.settings, variables, options.cases.beacon).given_toml());
  return left_out == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app(
      "tune",
      "It prints what it changed as a TOML file; Ctrl-C ends the search and prints the best so "
      "far. A case without "
      "truth counts with its prediction errors. To search settings that the preset sets, add --set "
      "documented.imu_weight=user.");
  add_options(app, options);
  return apps::run(app, argc, argv, [&] { return tune(options); });
}
