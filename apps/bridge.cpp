// sonopose-bridge: reads beacons (or a recording, or the simulator) and publishes their samples.

#include "support/app.hpp"
#include <sonopose/nodes/bridge_node.hpp>
#include <sonopose/nodes/byte_sources.hpp>
#include <sonopose/nodes/recorded_sources.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace {

using namespace sonopose;

struct Options {
  apps::BusOptions bus;
  std::string source = "sim";
  std::string input;
  nodes::SimulatorOptions sim;
  nodes::SerialOptions serial;
  std::string listen = "0.0.0.0:49100";
  std::optional<std::filesystem::path> capture;
  std::optional<std::filesystem::path> record;
  BeaconAddress address = 7;
  double rate = 1;
  bool restamp = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--source", options.source, "Where samples come from: sim, log, stream, serial or udp")
      ->check(CLI::IsMember({"sim", "log", "stream", "serial", "udp"}))
      ->capture_default_str();
  app.add_option("--input", options.input, "The sensor-log folder (log) or file of raw beacon bytes (stream)")
      ->type_name("PATH");
  app.add_option("--rate", options.rate,
                 "Speed of sim, log and stream: 1 is real time, 0 as fast as readers take it")
      ->check(CLI::Range(0.0, 1e6).description("[0 - 1e6]"))
      ->capture_default_str();
  app.add_flag("--restamp", options.restamp, "Shift a log's stamps so that it begins now");
  app.add_option("--address", options.address, "Beacon address of sim and log")
      ->check(CLI::Range(0, 65534))
      ->capture_default_str();
  app.add_option("--device", options.serial.device, "Serial device; waited for while it is absent")
      ->capture_default_str();
  app.add_option("--baud", options.serial.baud, "Baud rate; USB devices ignore it")
      ->check(CLI::Range(1200U, 4'000'000U))
      ->capture_default_str();
  app.add_option("--listen", options.listen, "UDP address and port to listen on")
      ->type_name("ADDR:PORT")
      ->capture_default_str();
  app.add_option("--capture", options.capture, "Keep the raw bytes of the beacon in this file")
      ->type_name("FILE");
  app.add_option("--record", options.record, "Write what is published as a sensor-log folder")
      ->type_name("DIR");
  app.add_option("--scenario", options.sim.scenario, "What the simulated beacon does")->capture_default_str();
  app.add_option("--imu-rate", options.sim.imu_rate_hz,
                 "IMU rate of the simulator in Hz (default: the scenario's)")
      ->check(CLI::Range(1.0, 1000.0).description("[1 - 1000]"));
  app.add_option("--seed", options.sim.seed, "Seed of the simulator's noise")->capture_default_str();
  app.add_option("--duration", options.sim.duration_s, "Length of the simulation in seconds; 0: without end")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

const std::string& required_input(const Options& options) {
  if (options.input.empty()) throw CLI::RequiredError("--source " + options.source + ": --input");
  return options.input;
}

/// Whether the source has a speed of its own that --rate can change, rather than a line's.
bool is_played(const Options& options) {
  return options.source != "serial" && options.source != "udp";
}

std::unique_ptr<nodes::Source> make_source(const Options& options) {
  if (options.capture && (options.source == "log" || options.source == "stream")) {
    throw std::invalid_argument("--capture goes with --source sim, serial or udp, not with " +
                                options.source);
  }
  if (options.source == "log") {
    return nodes::make_log_source({required_input(options), options.address, options.rate, options.restamp});
  }
  if (options.source == "stream") {
    return nodes::make_stream_source({required_input(options), options.rate});
  }
  if (options.source == "serial") return nodes::make_serial_source(options.serial, options.capture);
  if (options.source == "udp") return nodes::make_udp_source(options.listen, options.capture);
  nodes::SimulatorOptions sim = options.sim;
  sim.address = options.address;
  sim.rate = options.rate;
  sim.capture = options.capture;
  return nodes::make_simulator_source(sim);
}

int serve(const Options& options) {
  const auto source = make_source(options);
  nodes::StopSignal stop;
  stop.listen_to_signals();
  nodes::BridgeNode node(
      {options.bus.domain, options.bus.qos_file, is_played(options) && options.rate == 0.0, options.record});
  fmt::print(stderr, "sonopose-bridge: publishing from {}\n", options.source);
  node.run(*source, stop);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Publishes the samples of Marvelmind beacons, of a recording, or of the built-in simulator.",
               "sonopose-bridge");
  apps::add_bus_options(app, options.bus);
  add_options(app, options);
  return apps::run(app, argc, argv, [&options] { return serve(options); });
}
