#pragma once
/// \file
/// The options that select and configure a bridge's source.

#include "bridge/byte_sources.hpp"
#include "bridge/log_source.hpp"
#include "bridge/simulator_source.hpp"
#include "command_line.hpp"
#include "given_options.hpp"

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

  /// Returns true if the source has several beacons.
  [[nodiscard]] bool is_many() const { return source == "sim" && sim.beacons > 1; }
  /// Returns true if the source is played as fast as its readers accept.
  [[nodiscard]] bool is_unpaced() const { return source != "serial" && source != "udp" && rate == 0.0; }
};

/// The group of these options.
inline constexpr const char* source_group = "Source";

/// Adds --source and the options of all sources.
void add_source_options(CommandLine& app, SourceOptions& options);

/// Returns the description of the source for a recording: the given options, and the important ones.
NamedValues source_settings(const CommandLine& app, const SourceOptions& options);

/// Throws std::invalid_argument if a given option does not apply to the source.
void check_source_options(const CommandLine& app, const SourceOptions& options);

/// Creates the source. Throws its exceptions, and the error of a missing option.
std::unique_ptr<publication::Source> make_source(const SourceOptions& options);

}  // namespace sonopose::apps
