#pragma once
// The options for the bus, common to all its programs.

#include "run.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::apps {

/// Options for joining the bus.
struct BusOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
};

/// Throws std::invalid_argument if a publishing program has a pattern as partition: no reader with a plain
/// partition name would match it.
void check_publisher(const BusOptions& options);

/// The group of these options.
inline constexpr const char* bus_group = "Bus";

/// Adds --domain, --network, --partition and --qos. From now on, messages of DDS are lines of the log.
void add_bus_options(CLI::App& app, BusOptions& options);

/// Adds --max-beacons. `verb` says what the program does with beacons: "Serve".
void add_max_beacons(CLI::App& app, const std::string& verb, std::size_t& max_beacons);

}  // namespace sonopose::apps
