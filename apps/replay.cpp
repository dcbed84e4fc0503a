// sonopose-replay: runs the fusion engine over a sensor-log folder, without DDS and without a clock.

#include "evaluation/output_folder.hpp"
#include "evaluation/report.hpp"
#include "evaluation/run.hpp"
#include "evaluation/state_file.hpp"
#include "plots/plot.hpp"
#include "recording/log_folder.hpp"
#include "support/choice.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <optional>

namespace {

using namespace sonopose;
using Path = std::filesystem::path;
using Clock = std::chrono::steady_clock;

struct Options {
  Path log;
  apps::ConfigOptions config;
  std::optional<BeaconAddress> beacon;
  std::optional<Path> out;
  std::optional<Path> plot;
  std::optional<Path> save_state;
  std::optional<Path> load_state;
  evaluation::RunOptions run;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  const CLI::Validator seconds = CLI::Range(0.0, 1e9).description("[0 - 1e9]");
  app.add_option("LOG", options.log, "Sensor-log folder")->required()->type_name("DIR");
  apps::add_config_options(app, options.config);
  apps::add_beacon_option(app, options.beacon);
  app.add_option(
         "--out", options.out,
         "Write trajectory.tum, pose.csv and fixes.csv to this folder; replaces those of an earlier run")
      ->type_name("DIR");
  app.add_option("--after", options.run.after_s,
                 "Score the poses from this many seconds after the first event")
      ->check(seconds)
      ->capture_default_str();
  app.add_option("--until", options.run.until_s, "Stop this many seconds after the first event")
      ->check(seconds);
  app.add_flag("--json", options.json, "Print one JSON object instead of text");
  app.add_option("--plot", options.plot,
                 "Draw path, error, speed and fix flags to a .svg or .png file (needs gnuplot)")
      ->type_name("FILE");
  auto* const engine = apps::add_choice<std::optional<estimation::EstimatorKind>>(
      app, "--engine", options.run.estimator,
      {{"documented", estimation::EstimatorKind::documented},
       {"kalman", estimation::EstimatorKind::kalman},
       {"strapdown", estimation::EstimatorKind::strapdown}},
      "Instead of fusion.engine; strapdown: only the IMU, integrated from the truth");
  app.add_option("--init", "Start of strapdown: the first complete truth of the log")
      ->check(CLI::IsMember({"truth"}))
      ->needs(engine);
  apps::add_choice<estimation::strapdown::Rule>(
      app, "--integration", options.run.strapdown_rule,
      {{"previous", estimation::strapdown::Rule::previous}, {"mean", estimation::strapdown::Rule::mean}},
      "What strapdown integrates over a step: the previous sample, or the mean of both samples")
      ->needs(engine);
  app.add_option("--save-state", options.save_state, "Write the final state of the engine to a JSON file")
      ->type_name("FILE");
  app.add_option("--load-state", options.load_state,
                 "Continue from a saved state with the events that follow it")
      ->type_name("FILE");
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The configuration, with --engine instead of fusion.engine.
config::FusionConfig configuration(const CLI::App& app, const Options& options) {
  apps::ConfigOptions config = options.config;
  if (options.run.estimator && *options.run.estimator != estimation::EstimatorKind::strapdown) {
    const auto index = static_cast<std::size_t>(*options.run.estimator);
    config.assignments.push_back(fmt::format("fusion.engine={}", choices_of(*options.run.estimator)[index]));
  }
  return apps::configuration(app, config);
}

int replay_log(const CLI::App& app, const Options& options) {
  evaluation::RunOptions run = options.run;
  const config::FusionConfig config = configuration(app, options);
  if (options.load_state) run.start = evaluation::load_state(*options.load_state);

  evaluation::Timing timing;
  const auto reading = Clock::now();
  const recording::SensorLog log = recording::read_sensor_log(options.log, options.beacon);
  timing.reading_s = seconds_since(reading);
  run.settings = config.for_beacon(log.address);
  if (run.start) evaluation::check_fits(*run.start, log, options.load_state->string());
  std::optional<evaluation::OutputFolder> out;
  std::optional<plots::Plot> plot;
  if (options.out) out.emplace(*options.out);
  if (options.plot) plot.emplace(*options.plot, options.log.string(), log);
  const auto running = Clock::now();
  const auto write = [&](const auto& sample) {
    if (out) out->write(sample);
    if (plot) plot->add(sample);
  };
  const evaluation::RunResult result = evaluation::run(log, run, {write, write});
  if (out) out->finish();
  timing.running_s = seconds_since(running);
  if (options.save_state) evaluation::save_state(*options.save_state, result.end);
  if (plot) plot->draw();
  fmt::print(
      "{}", options.json ? evaluation::report_json(result, timing) : evaluation::report_text(result, timing));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("replay");
  add_options(app, options);
  return sonopose::apps::run(app, argc, argv, [&] { return replay_log(app, options); });
}
