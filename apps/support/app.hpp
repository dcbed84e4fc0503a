#pragma once
// What every program has in common: its options for the bus, and how it ends.

#include <sonopose/dds/domain.hpp>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace sonopose::apps {

/// How a program joins the bus.
struct BusOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
};

/// Adds --domain, --network and --qos.
void add_bus_options(CLI::App& app, BusOptions& options);

/// Parses the command line and runs `body`. Returns the exit code: 0 for success, help and a stop by signal;
/// the command line's own errors as CLI11 numbers them; 1 for any exception, whose reason goes to stderr.
int run(CLI::App& app, int argc, char** argv, const std::function<int()>& body);

}  // namespace sonopose::apps
