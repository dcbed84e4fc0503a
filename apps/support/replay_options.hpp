#pragma once
// The options of sonopose-replay.

#include "config_options.hpp"
#include "evaluation/replay/run.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::apps {

struct ReplayOptions {
  std::filesystem::path log;
  ConfigOptions config;
  std::vector<std::filesystem::path> compared;  ///< two files of settings, or none
  std::optional<BeaconAddress> beacon;
  std::optional<std::filesystem::path> out;
  std::optional<std::filesystem::path> plot;
  std::optional<std::filesystem::path> save_state;
  std::optional<std::filesystem::path> load_state;
  evaluation::RunOptions run;
  bool smooth = false;
  bool json = false;
};

void add_replay_options(CLI::App& app, ReplayOptions& options);

/// Reads the configuration, with --engine instead of fusion.engine. Throws config::ConfigError.
config::FusionConfig configuration(const CLI::App& app, const ReplayOptions& options);

}  // namespace sonopose::apps
