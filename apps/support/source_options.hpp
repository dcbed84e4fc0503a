#pragma once
/// \file
/// The options that select and configure a bridge's source.

#include "bridge/byte_sources.hpp"
#include "bridge/log_source.hpp"
#include "bridge/simulator_source.hpp"
#include "given_options.hpp"

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
  bridge::UdpOptions udp;
  std::optional<std::filesystem::path> capture;
  std::optional<BeaconAddress> address;
  std::optional<ImuMeaning> imu_meaning;
  std::optional<std::size_t> max_beacons;
  double rate = 1;
  bool restamp = false;

  /// Whether the source has more than one beacon.
  [[nodiscard]] bool is_many() const { return source == "sim" && sim.beacons > 1; }
  /// Whether it is played as fast as its readers accept.
  [[nodiscard]] bool is_unpaced() const { return source != "serial" && source != "udp" && rate == 0.0; }
};

/// The group of these options.
inline constexpr const char* source_group = "Source";

/// Adds --source and the options of all sources.
void add_source_options(CLI::App& app, SourceOptions& options);

/// What a recording says of its source: the options that were given, and the important ones.
NamedValues source_settings(const CLI::App& app, const SourceOptions& options);

/// Throws std::invalid_argument if an option was given that the source does not read.
void check_source_options(const CLI::App& app, const SourceOptions& options);

/// Throws what the source throws, and CLI::RequiredError.
std::unique_ptr<bridge::Source> make_source(const SourceOptions& options);

}  // namespace sonopose::apps
