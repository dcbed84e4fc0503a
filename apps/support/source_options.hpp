#pragma once
// Where a bridge's samples come from: the options that say so, and the source that they lead to.

#include "bridge/byte_sources.hpp"
#include "bridge/recorded_sources.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::apps {

struct SourceOptions {
  std::string source = "sim";
  std::string input;
  bridge::SimulatorOptions sim;
  bridge::SerialOptions serial;
  std::string listen = "0.0.0.0:49100";
  std::optional<std::filesystem::path> capture;
  BeaconAddress address = 7;
  double rate = 1;
  bool restamp = false;

  /// Whether it brings more beacons than one.
  [[nodiscard]] bool is_many() const { return source == "sim" && sim.beacons > 1; }
  /// Whether it is played as fast as its readers take it.
  [[nodiscard]] bool is_unpaced() const { return source != "serial" && source != "udp" && rate == 0.0; }
};

/// Adds --source and all that belongs to one of the sources.
void add_source_options(CLI::App& app, SourceOptions& options);

/// Throws what the source throws; std::invalid_argument for options that do not go together,
/// CLI::RequiredError.
std::unique_ptr<bridge::Source> make_source(const SourceOptions& options);

}  // namespace sonopose::apps
