// sonopose-replay: runs the fusion engine over a sensor-log folder, without DDS and without a clock.

#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "evaluation/replay/run.hpp"
#include "evaluation/replay/smoothed_run.hpp"
#include "evaluation/report/output_folder.hpp"
#include "evaluation/report/report.hpp"
#include "evaluation/state/state_file.hpp"
#include "plots/plot.hpp"
#include "support/progress.hpp"
#include "support/replay_options.hpp"
#include "support/run.hpp"
#include "support/waiting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace sonopose;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Returns the name of strapdown integration, which is no engine of the settings; otherwise empty.
std::string run_name(const evaluation::RunOptions& run) {
  return run.strapdown ? "strapdown" : "";
}

evaluation::RunResult timed_run(const recording::SensorLog& log, const evaluation::RunOptions& run,
                                bool smooth, const evaluation::Observer& observer,
                                evaluation::Timing& timing) {
  apps::Progress progress;
  const TimeNs begin_ns = log.events.empty() ? 0 : available_at_ns(log.events.front());
  const TimeNs end_ns = log.events.empty() ? 0 : available_at_ns(log.events.back());
  const auto share_at = [&](TimeNs time_ns) {
    return seconds_between(begin_ns, time_ns) / std::max(seconds_between(begin_ns, end_ns), 1e-9);
  };
  const evaluation::Observer watched{[&](const FusedPose& pose) {
                                       progress.at(share_at(pose.time_ns), "replay");
                                       observer.on_pose(pose);
                                     },
                                     [&](const FixReport& fix) {
                                       progress.at(share_at(fix.applied_time_ns), "replay");
                                       observer.on_report(fix);
                                     }};
  const auto running = Clock::now();
  evaluation::RunResult result = (smooth ? evaluation::run_smoothed : evaluation::run)(log, run, watched);
  timing.running_s = seconds_since(running);
  return result;
}

std::string report(const evaluation::RunResult& result, const evaluation::Timing& timing, bool json) {
  return json ? evaluation::report_json(result, timing) : evaluation::report_text(result, timing);
}

recording::SensorLog read_log(const apps::ReplayOptions& options, evaluation::Timing& timing) {
  const apps::Waiting waiting("reading " + bus_log::name_of(options.logs));
  const auto reading = Clock::now();
  recording::SensorLog log = bus_log::read_sensor_log(options.logs, options.beacon);
  timing.reading_s = seconds_since(reading);
  return log;
}

void draw(std::optional<plots::Plot>& plot) {
  if (!plot) return;
  const apps::Waiting waiting("drawing");
  plot->draw();
}

/// Runs the log with each of the two files; --set applies to both.
int compare(const apps::ReplayOptions& options) {
  std::vector<config::FusionConfig> configs;
  for (const auto& file : options.compared) {
    apps::ReplayOptions one = options;
    one.config.file = file;
    configs.push_back(configuration(one));
  }
  evaluation::Timing timing;
  const recording::SensorLog log = read_log(options, timing);
  std::vector<evaluation::RunResult> results;
  std::optional<plots::Plot> plot;
  if (options.plot) plot.emplace(*options.plot, bus_log::name_of(options.logs), log);
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const std::string name = options.compared[i].string();
    const evaluation::RunOptions run = run_options(options, apps::settings_of(configs[i], log.address));
    plots::RunCurves* const curves = plot ? &plot->add_run(name, run.settings, run_name(run)) : nullptr;
    const auto add = [curves](const auto& sample) {
      if (curves != nullptr) curves->add(sample);
    };
    results.push_back(timed_run(log, run, options.smooth, {add, add}, timing));
    if (!options.json) apps::print("{}{}\n", i == 0 ? "" : "\n", name);
    apps::print("{}", report(results.back(), timing, options.json));
  }
  draw(plot);
  apps::Warnings warnings;
  for (std::size_t i = 0; i < results.size(); ++i)
    require_result(options, log, apps::settings_of(configs[i], log.address), results[i], warnings);
  return 0;
}

int replay_log(const apps::ReplayOptions& options) {
  if (!options.compared.empty()) return compare(options);
  const config::FusionConfig config = configuration(options);
  std::optional<evaluation::SavedState> start;
  if (options.load_state) start = evaluation::load_state(*options.load_state);
  evaluation::Timing timing;
  const recording::SensorLog log = read_log(options, timing);
  evaluation::RunOptions run = run_options(options, apps::settings_of(config, log.address));
  if (start) evaluation::check_fits(*start, log, options.load_state->string());
  run.start = start;
  std::optional<evaluation::OutputFolder> out;
  if (options.out) {
    using Covariances = evaluation::OutputFolder::Covariances;
    out.emplace(*options.out, options.smooth ? Covariances::yes : Covariances::no);
  }
  std::optional<plots::Plot> plot;
  if (options.plot) plot.emplace(*options.plot, bus_log::name_of(options.logs), log);
  plots::RunCurves* const curves =
      plot ? &plot->add_run(options.smooth ? "smoothed" : "fused", run.settings, run_name(run)) : nullptr;
  const auto write = [&](const auto& sample) {
    if (out) out->write(sample);
    if (curves != nullptr) curves->add(sample);
  };
  const auto result = timed_run(log, run, options.smooth, {write, write}, timing);
  if (out) out->finish();
  if (options.save_state) evaluation::save_state(*options.save_state, result.end);
  draw(plot);
  apps::print("{}", report(result, timing, options.json));
  apps::Warnings warnings;
  require_result(options, log, run.settings, result, warnings);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  apps::ReplayOptions options;
  apps::Program app("replay");
  apps::add_replay_options(app, options);
  return sonopose::apps::run(app, argc, argv, [&] { return replay_log(options); });
}
