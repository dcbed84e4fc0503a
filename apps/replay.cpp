// sonopose-replay: the fusion's engine over a sensor-log folder, without bus and without clock.

#include "support/choice.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"
#include "recording/log_folder.hpp"
#include "evaluation/output_folder.hpp"
#include "plots/picture.hpp"
#include "evaluation/report.hpp"
#include "evaluation/run.hpp"
#include "evaluation/state_file.hpp"

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
  BeaconAddress beacon = recording::default_log_address;
  std::optional<Path> out;
  std::optional<Path> picture;
  std::optional<Path> save_state;
  std::optional<Path> load_state;
  evaluation::RunOptions run;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  const CLI::Validator seconds = CLI::Range(0.0, 1e9).description("[0 - 1e9]");
  app.add_option("LOG", options.log, "The sensor-log folder")->required()->type_name("DIR");
  apps::add_config_options(app, options.config);
  apps::add_beacon_option(app, options.beacon);
  app.add_option("--out", options.out,
                 "Write trajectory.tum, pose.csv and fixes.csv here, replacing those of a run before")
      ->type_name("DIR");
  app.add_option("--after", options.run.after_s, "Score poses from so many seconds after the first event on")
      ->check(seconds)
      ->capture_default_str();
  app.add_option("--until", options.run.until_s, "End so many seconds after the first event")->check(seconds);
  app.add_flag("--json", options.json, "One JSON object instead of the lines");
  app.add_option("--plot", options.picture,
                 "Draw path, error, speed and fix_flags: a file .svg or .png (needs gnuplot)")
      ->type_name("FILE");
  auto* const engine = apps::add_choice<evaluation::EngineKind>(
      app, "--engine", options.run.engine,
      {{"fusion", evaluation::EngineKind::fusion}, {"strapdown", evaluation::EngineKind::strapdown}},
      "strapdown: the IMU alone, integrated from the truth");
  app.add_option("--init", "Where strapdown starts: at the log's first complete truth")
      ->check(CLI::IsMember({"truth"}))
      ->needs(engine);
  apps::add_choice<estimation::StrapdownRule>(
      app, "--integration", options.run.strapdown_rule,
      {{"previous", estimation::StrapdownRule::previous}, {"mean", estimation::StrapdownRule::mean}},
      "Held over a step of strapdown: the previous sample, as its document says, or the mean of both")
      ->needs(engine);
  app.add_option("--save-state", options.save_state, "Write the engine's state at the end, a JSON file")
      ->type_name("FILE");
  app.add_option("--load-state", options.load_state, "Go on from such a state, with the events behind it")
      ->type_name("FILE");
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

int replay_log(const CLI::App& app, const Options& options) {
  evaluation::RunOptions run = options.run;
  if (run.engine == evaluation::EngineKind::strapdown && (options.save_state || options.load_state)) {
    throw CLI::ValidationError("--save-state and --load-state", "go with --engine fusion");
  }
  run.settings = apps::configuration(app, options.config).for_beacon(options.beacon);
  if (options.load_state) run.start = evaluation::load_state(*options.load_state);

  evaluation::Timing timing;
  const auto reading = Clock::now();
  const recording::SensorLog log = recording::read_sensor_log(options.log, options.beacon);
  timing.reading_s = seconds_since(reading);
  if (run.start) evaluation::check_fits(*run.start, log, options.load_state->string());
  std::optional<evaluation::OutputFolder> out;
  std::optional<plots::Picture> picture;
  if (options.out) out.emplace(*options.out);
  if (options.picture) picture.emplace(*options.picture, options.log.string(), log);
  const auto running = Clock::now();
  const auto tell = [&](const auto& sample) {
    if (out) out->write(sample);
    if (picture) picture->add(sample);
  };
  const evaluation::RunResult result = evaluation::run(log, run, {tell, tell});
  if (out) out->finish();
  timing.running_s = seconds_since(running);
  if (options.save_state) evaluation::save_state(*options.save_state, result.end);
  if (picture) picture->draw();
  fmt::print("{}", options.json ? evaluation::report_json(result, timing) : evaluation::report_text(result, timing));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Runs the fusion over a recording, as fast as it can, and scores it where the truth is known.",
               "sonopose-replay");
  add_options(app, options);
  return sonopose::apps::run(app, argc, argv, [&] { return replay_log(app, options); });
}
