#include "source_options.hpp"

#include "expanded_option.hpp"
#include "files/error.hpp"
#include "imu_meaning_option.hpp"
#include "run.hpp"
#include "sim/scenario.hpp"
#include "transport/udp_listener.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace sonopose::apps {
namespace {

constexpr std::size_t default_max_beacons = presence::BeaconAdmission::default_max_beacons;

const std::string& required_input(const SourceOptions& options) {
  if (options.input.empty()) require_option("--source " + options.source + ": --input");
  return options.input;
}

/// An option, and the sources that read it.
struct Reader {
  const char* option;
  std::vector<std::string_view> sources;
};

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{{"--input", {"log", "mcap", "stream"}},
                                       {"--rate", {"sim", "log", "mcap", "stream"}},
                                       {"--restamp", {"log", "mcap"}},
                                       {"--max-expanded", {"mcap"}},
                                       {"--address", {"sim", "log", "mcap"}},
                                       {"--beacons", {"sim"}},
                                       {"--device", {"serial"}},
                                       {"--baud", {"serial"}},
                                       {"--imu-meaning", {"serial", "udp", "stream"}},
                                       {"--listen", {"udp"}},
                                       {"--from", {"udp"}},
                                       {"--max-beacons", {"serial", "udp", "stream"}},
                                       {"--capture", {"sim", "serial", "udp"}},
                                       {"--scenario", {"sim"}},
                                       {"--imu-rate", {"sim"}},
                                       {"--seed", {"sim"}},
                                       {"--duration", {"sim"}}};
  return all;
}

/// Returns true for both forms of a log, which are read alike.
bool is_log(const SourceOptions& options) {
  return options.source == "log" || options.source == "mcap";
}

}  // namespace

void add_source_options(CommandLine& app, SourceOptions& options) {
  app.set_default_group(source_group);
  app.add_option("--source", options.source, "Source: sim, log, mcap, stream, serial, udp")
      .check(one_of({"sim", "log", "mcap", "stream", "serial", "udp"}))
      .capture_default_str();
  app.add_option("--input", options.input,
                 "Sensor-log folder (log), recording of the bus (mcap) or file of raw beacon bytes (stream)")
      .type_name("PATH");
  app.add_option(
         "--rate", options.rate,
         "Speed of sim, log, mcap and stream: 1 is real time, 0 is as fast as the readers accept, without "
         "loss to a fusion with --lossless")
      .check(number_between(0.0, 1e6))
      .capture_default_str();
  app.add_flag("--restamp", options.restamp, "Shift the time stamps of a log or mcap so that it starts now");
  add_expanded_option(app);
  app.add_option("--address", options.address,
                 "Beacon address of sim and log (default: the one in meta.toml of a log, else 7); with mcap, "
                 "the beacon that is read, if the recording has several")
      .check(number_between(0, 65534));
  app.add_option("--beacons", options.sim.beacons,
                 "Number of beacons of sim, each with the next address and seed")
      .check(number_between(1U, bridge::max_simulated_beacons))
      .capture_default_str();
  app.add_option(
         "--device", options.serial.device,
         "Serial device, best its lasting name in /dev/serial/by-id; the bridge waits for it while it "
         "is absent")
      .type_name("PATH")
      .capture_default_str();
  app.add_option("--baud", options.serial.baud, "Baud rate; USB devices ignore it")
      .check(number_between(1200U, 4'000'000U))
      .capture_default_str();
  add_choice<std::optional<ImuMeaning>>(
      app, "--imu-meaning", options.imu_meaning, imu_meaning_choices(),
      "What an IMU sample of serial, udp and stream is: the value at its instant, or the mean since the "
      "previous one; the beacons do not say (default: unknown)");
  app.add_option("--listen", options.udp.listen, "UDP address and port to listen on")
      .check(readable_by(transport::parse_endpoint))
      .type_name("ADDR:PORT")
      .capture_default_str();
  app.add_option("--from", options.udp.from,
                 "Accept datagrams of this address only (default: of all; each beacon has one sender)")
      .check(readable_by(transport::check_address))
      .type_name("ADDR");
  app.add_option("--max-beacons", options.max_beacons,
                 fmt::format("Accept at most this many beacons at a time from serial and udp, the first ones "
                             "that are heard; a stream with more is an error (default: {})",
                             default_max_beacons))
      .check(number_between(std::size_t{1}, default_max_beacons))
      .type_name("N");
  app.add_option("--capture", options.capture, "Write the raw bytes of the beacon to this file")
      .type_name("FILE");
  app.add_option("--scenario", options.sim.scenario, "Scenario of sim")
      .check(readable_by(sim::find_scenario))
      .capture_default_str();
  app.add_option("--imu-rate", options.sim.imu_rate_hz,
                 "IMU rate of the simulator in Hz (default: the scenario's)")
      .check(number_between(1.0, 1000.0));
  app.add_option("--twist", options.sim.wheel_rate_hz,
                 "Rate in Hz of the speed of simulated wheels, along body X (default: the scenario's)")
      .check(number_between(1.0, 1000.0))
      .type_name("HZ");
  app.add_option("--seed", options.sim.seed, "Seed of the simulator's noise")
      .check(number_between(0, 1e9))
      .capture_default_str();
  app.add_option("--duration", options.sim.duration_s,
                 "Length of the simulation in seconds; 0: run until stopped")
      .check(number_between(0.0, 1e9))
      .capture_default_str();
  app.set_default_group("Options");
}

NamedValues source_settings(const CommandLine& app, const SourceOptions& options) {
  std::vector<std::string> always{"source"};
  if (options.source == "sim") always.insert(always.end(), {"scenario", "seed"});
  if (options.source == "serial") always.emplace_back("device");
  if (options.source == "udp") always.emplace_back("listen");
  return option_values(app, source_group, always);
}

void check_source_options(const CommandLine& app, const SourceOptions& options) {
  for (const Option& given : app.options()) {
    if (given.group_name() != source_group || given.count() == 0 || given.has_name("--source")) continue;
    const auto entry = std::find_if(readers().begin(), readers().end(),
                                    [given](const Reader& each) { return given.has_name(each.option); });
    if (entry == readers().end()) throw std::logic_error(given.name() + " is read by no source");
    const auto& [option, sources] = *entry;
    if (std::find(sources.begin(), sources.end(), options.source) != sources.end()) continue;
    const std::string others = fmt::format("{}", fmt::join(sources.begin(), sources.end() - 1, ", "));
    throw std::invalid_argument(fmt::format("{} only works with --source {}{}{}, not with {}", option, others,
                                            others.empty() ? "" : " or ", sources.back(), options.source));
  }
}

std::unique_ptr<publication::Source> make_source(const SourceOptions& options) {
  const std::size_t max_beacons = options.max_beacons.value_or(default_max_beacons);
  const ImuMeaning imu_meaning = options.imu_meaning.value_or(bridge::default_imu_meaning);
  try {
    if (is_log(options)) {
      return bridge::make_log_source(
          {required_input(options), options.address, options.rate, options.restamp});
    }
    if (options.source == "stream") {
      return bridge::make_stream_source({required_input(options), options.rate, imu_meaning, max_beacons});
    }
  } catch (const files::IoError& error) {
    throw std::invalid_argument(fmt::format("--input: {}", error.what()));
  }
  const bridge::LiveOptions live{options.capture, imu_meaning, max_beacons};
  if (options.source == "serial") return bridge::make_serial_source(options.serial, live);
  if (options.source == "udp") return bridge::make_udp_source(options.udp, live);
  bridge::SimulatorOptions sim = options.sim;
  sim.address = options.address.value_or(sim.address);
  sim.rate = options.rate;
  sim.capture = options.capture;
  return bridge::make_simulator_source(sim);
}

}  // namespace sonopose::apps
