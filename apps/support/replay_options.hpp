#pragma once
// The options of sonopose-replay.

#include "command_line.hpp"
#include "config_options.hpp"
#include "evaluation/replay/run.hpp"
#include "installation_warning.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::apps {

/// Choices of --engine: those of settings::EngineKind in their order, and strapdown integration.
enum class ReplayEngine { documented, kalman, strapdown };

struct ReplayOptions {
  std::vector<std::filesystem::path> logs;  ///< a recording, in several MCAP files or one of any kind
  ConfigOptions config;
  std::vector<std::filesystem::path> compared;  ///< two files of settings, or none
  std::optional<BeaconAddress> beacon;
  std::optional<std::filesystem::path> out;
  std::optional<std::filesystem::path> plot;
  std::optional<std::filesystem::path> save_state;
  std::optional<std::filesystem::path> load_state;
  std::optional<ReplayEngine> engine;
  evaluation::strapdown::Rule integration = evaluation::strapdown::Rule::previous;
  evaluation::RunOptions run;  ///< complete it with `run_options`
  bool smooth = false;
  bool json = false;
};

void add_replay_options(CommandLine& app, ReplayOptions& options);

/// Reads the configuration, with --engine instead of fusion.engine. Throws config::ConfigError.
config::FusionConfig configuration(const ReplayOptions& options);

/// Throws std::runtime_error with the cause if the run used no fix, unless it is strapdown integration, or if
/// it has truth and no score. A run that ends early needs neither.
void require_result(const ReplayOptions& options, const recording::SensorLog& log,
                    const settings::Settings& settings, const evaluation::RunResult& result,
                    Warnings& warnings);

/// Options of a run with these settings.
evaluation::RunOptions run_options(const ReplayOptions& options, const settings::Settings& settings);

}  // namespace sonopose::apps
