#pragma once
// What every program on the bus has in common: its options for the bus.

#include "run.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::apps {

/// How a program joins the bus.
struct BusOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
};

/// Throws std::invalid_argument if the partition of a program that publishes is a pattern: no reader that
/// asks for a partition of a plain name would match it.
void check_publisher(const BusOptions& options);

/// The group of these options.
inline constexpr const char* bus_group = "Bus";

/// Adds --domain, --network, --partition and --qos.
void add_bus_options(CLI::App& app, BusOptions& options);

/// Adds --max-beacons. `verb` is what the program does with beacons: "Serve".
void add_max_beacons(CLI::App& app, const std::string& verb, std::size_t& max_beacons);

}  // namespace sonopose::apps
