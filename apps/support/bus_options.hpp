#pragma once
// The options for the bus, common to all its programs.

#include "process/stop_signal.hpp"
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
  std::optional<std::filesystem::path> key_store;
  std::optional<std::string> enclave;  ///< absent: named after the program's role
  bool joins_bus = true;  ///< false for a program that only passes the options on, which each have an enclave
};

/// Throws std::invalid_argument if a publishing program has a pattern as partition: no reader with a plain
/// partition name would match it.
void check_publisher(const BusOptions& options);

/// The group of these options.
inline constexpr const char* bus_group = "Bus";

/// Adds --domain, --network, --interface, --partition, --qos, --security and --enclave. From now on, messages
/// of DDS are lines of the log.
void add_bus_options(CommandLine& app, BusOptions& options);

/// Waits until the network is there: with `--network lan` any interface besides loopback, with --interface
/// the named ones. Meanwhile, it reports to the service manager. Logs what is missing, then the interfaces
/// and why they are used, and the security in use. Returns false if the stop came first.
/// Throws std::runtime_error if the network is still missing after `duration_s`; 0: waits without limit.
bool wait_for_network(const dds::DomainOptions& domain, const process::StopSignal& stop,
                      double duration_s = 0.0);

/// Adds --max-beacons. `verb` says what the program does with beacons: "Serve".
void add_max_beacons(CommandLine& app, const std::string& verb, std::size_t& max_beacons);

}  // namespace sonopose::apps
