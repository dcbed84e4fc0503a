#include "replay_options.hpp"

#include "bag_options.hpp"
#include "bus_log/recording_files.hpp"
#include "choice.hpp"
#include "expanded_option.hpp"
#include "ros2/bag/topic_choice.hpp"
#include "run.hpp"
#include <sonopose/samples/status_meanings.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

namespace sonopose::apps {
namespace {

/// True if a topic of the command line has this input.
bool is_chosen(const evaluation::UnusedInput& input) {
  using Kind = ros2::AidingInput::Kind;
  return std::ranges::any_of(ros2::bag::chosen_topics().aiding, [&input](const auto& chosen) {
    return (chosen.first == Kind::heading || chosen.first == Kind::pose) == input.is_heading;
  });
}

}  // namespace

void add_replay_options(CommandLine& app, ReplayOptions& options) {
  const Check seconds = number_between(0.0, 1e9);
  app.add_option("LOG", options.logs,
                 "Sensor-log folder, or files of a recording (MCAP, rosbag2) or a folder of them")
      .required()
      .type_name("PATH");
  add_expanded_option(app);
  add_bag_options(app);
  add_config_options(app, options.config);
  add_beacon_option(app, options.beacon);
  app.add_option(
         "--out", options.out,
         "Write trajectory.tum, pose.csv and fixes.csv, with --smooth also covariance.csv, to this folder; "
         "replaces those of an earlier run")
      .type_name("DIR");
  app.add_option("--after", options.run.after_s,
                 "Score the poses from this many seconds after the first event")
      .check(seconds)
      .capture_default_str();
  app.add_option("--until", options.run.until_s, "Stop this many seconds after the first event")
      .check(seconds);
  app.add_flag("--json", options.json,
               "Print JSON instead of text: one object, or with --compare one for each file, in their order");
  app.add_option(
         "--plot", options.plot,
         "Draw path, errors, innovations, height, yaw and more to a .svg or .png file (needs gnuplot)")
      .type_name("FILE");
  app.add_option("--compare", options.compared,
                 "Run with each of two settings files instead of --config, print both results, and draw both "
                 "into one plot")
      .expected(2)
      .allow_extra_args(false)
      .type_name("FILE FILE")
      .excludes(app.option("--config"))
      .excludes(app.option("--out"));
  auto engine = add_choice<std::optional<ReplayEngine>>(
      app, "--engine", options.engine,
      {{"documented", ReplayEngine::documented},
       {"kalman", ReplayEngine::kalman},
       {"strapdown", ReplayEngine::strapdown}},
      "Instead of fusion.engine; strapdown: only the IMU, integrated from the truth");
  app.add_option("--init", "Start of strapdown: the first complete truth of the log")
      .check(one_of({"truth"}))
      .needs(engine);
  using evaluation::strapdown::Rule;
  add_choice<Rule>(app, "--integration", options.integration,
                   {{"previous", Rule::previous}, {"mean", Rule::mean}},
                   "What strapdown integrates over a step: the previous sample, or the mean of both samples")
      .needs(engine);
  auto smooth = app.add_flag("--smooth", options.smooth,
                             "Poses, scores and files from all measurements, those before and those "
                             "after each moment (Kalman engine)");
  app.add_option("--save-state", options.save_state, "Write the final state of the engine to a JSON file")
      .type_name("FILE")
      .excludes(app.option("--compare"));
  app.add_option("--load-state", options.load_state,
                 "Continue from a saved state with the events that follow it")
      .type_name("FILE")
      .excludes(app.option("--compare"))
      .excludes(smooth);
}

config::FusionConfig configuration(const ReplayOptions& options) {
  if (options.save_state && options.engine == ReplayEngine::strapdown) {
    throw config::ConfigError("--save-state: strapdown integration has no engine whose state can be saved");
  }
  ConfigOptions config = options.config;
  if (options.engine && *options.engine != ReplayEngine::strapdown) {
    const bool is_kalman = *options.engine == ReplayEngine::kalman;
    config.chosen.push_back({"fusion.engine", is_kalman ? "kalman" : "documented", std::nullopt});
  }
  return configuration(config);
}

namespace {

/// Events until a time after the first.
std::span<const Event> until(std::span<const Event> events, const std::optional<double>& until_s) {
  if (!until_s || events.empty()) return events;
  const TimeNs end_ns = available_at_ns(events.front()) + to_ns(*until_s);
  const auto end =
      std::ranges::find_if(events, [end_ns](const Event& event) { return available_at_ns(event) > end_ns; });
  return {events.begin(), end};
}

/// Warns of faults of the installation, and of contradictions that they do not explain.
void warn_of_contradictions(const std::string& name, std::span<const Event> events,
                            const settings::Settings& settings, const evaluation::RunResult& result,
                            Warnings& warnings) {
  const auto exceeds = [&result](PoseStatus bit, double share) {
    const auto found = result.warned.find(bit);
    return found != result.warned.end() &&
           static_cast<double>(found->second) > share * static_cast<double>(result.judged_poses);
  };
  const bool is_imu_wrong =
      exceeds(status_imu_inconsistent, 0.1) ||
      (exceeds(status_heading_unknown, 0.5) && 100 * result.counters.headings > result.judged_poses);
  const bool are_fixes_wrong = exceeds(status_fixes_inconsistent, 0.5);
  const bool is_contradicted = is_imu_wrong || are_fixes_wrong;
  if (warn_of_installation(name, events, settings,
                           is_contradicted ? installation::Search::thorough : installation::Search::brief,
                           warnings)) {
    return;
  }
  if (is_imu_wrong) {
    warnings.add(fmt::format(
        "{0}: the IMU contradicts fixes, headings or gravity: check its units, signs, axes and mount. "
        "`sonopose-calibrate mount {0}` measures the mount",
        name));
  }
  if (are_fixes_wrong) {
    warnings.add(fmt::format(
        "{0}: fixes are inconsistent at most poses: {1}. `sonopose-calibrate delay {0}` measures how far "
        "the clocks are apart",
        name, fixes_inconsistent_meaning));
  }
}

}  // namespace

void require_result(const ReplayOptions& options, const recording::SensorLog& log,
                    const settings::Settings& settings, const evaluation::RunResult& result,
                    Warnings& warnings) {
  const std::string name = bus_log::name_of(options.logs);
  for (const std::string& text : result.remarks) warnings.add(fmt::format("{}: {}", name, text));
  for (const evaluation::UnusedInput& input : result.unused_inputs) {
    const std::string text = fmt::format("{}: {}", name, input.text);
    if (is_chosen(input) && !options.run.until_s) throw std::runtime_error(text);
    warnings.add(text);
  }
  warn_of_contradictions(name, until(log.events, options.run.until_s), settings, result, warnings);
  if (result.poses > 0 && result.judged_poses == 0) {
    throw std::runtime_error(fmt::format("{}: no score: no pose comes {} s (--after) after the first event",
                                         name, options.run.after_s));
  }
  if (options.run.until_s) {
    const bool has_fixes = result.counters.fixes_used + result.counters.fixes_rejected > 0;
    if (has_fixes || options.engine == ReplayEngine::strapdown) return;
    const std::string text = fmt::format("{}: has no fix until {} s (--until)", name, *options.run.until_s);
    if (!options.save_state) throw std::runtime_error(text);
    warnings.add(text);
    return;
  }
  if (options.engine != ReplayEngine::strapdown && result.counters.fixes_used == 0) {
    if (result.counters.fixes_rejected == 0) throw std::runtime_error(name + ": has no fix");
    const std::string reason = result.refusals.reason();
    throw std::runtime_error(
        fmt::format("{}: no fix was used, {} rejected{}{}", name,
                    text::count_text(result.counters.fixes_rejected, "fix was", "fixes were"),
                    reason.empty() ? "" : ": ", reason));
  }
  const std::uint64_t fixes = result.counters.fixes_used + result.counters.fixes_rejected;
  if (const std::uint64_t refused = result.refusals.count(); 2 * refused > fixes) {
    const bool is_other_clock = result.refusals.are_of_another_clock();
    const std::string text = fmt::format(
        "{}: {} of {} were refused: {}{}", name, refused, text::count_text(fixes, "fix", "fixes"),
        result.refusals.reason(),
        is_other_clock ? "; `sonopose-calibrate delay " + name + "` measures how far the clocks are apart"
                       : "");
    // Some are refused as the user wants it.
    constexpr std::uint64_t min_use = 10;
    if (is_other_clock || min_use * result.counters.fixes_used < fixes) throw std::runtime_error(text);
    warnings.add(text);
  }
  const evaluation::Score& score = result.fused;
  if (!result.has_truth || score.poses > 0 || std::isfinite(score.tilt_rmse_deg)) return;
  throw std::runtime_error(
      fmt::format("{}: no score: none of {} has a true position: are the truth and the IMU of one clock?",
                  name, text::count_text(score.poses_without_truth, "pose")));
}

evaluation::RunOptions run_options(const ReplayOptions& options, const settings::Settings& settings) {
  evaluation::RunOptions run = options.run;
  run.settings = settings;
  if (options.engine == ReplayEngine::strapdown) {
    run.strapdown = options.integration;
  } else if (options.engine) {  // also against the file's settings of one beacon
    run.settings.engine.engine = static_cast<settings::EngineKind>(*options.engine);
  }
  return run;
}

}  // namespace sonopose::apps
