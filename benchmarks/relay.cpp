// Compares the CPU time of the ROS 2 relay with that of a process that reads and writes the same messages
// with bare Cyclone DDS. One bridge and one fusion run all the time; the rounds of both processes are
// interleaved.

#include "bare_relay.hpp"
#include "beacons_round.hpp"
#include "child.hpp"
#include "clocks/clocks.hpp"
#include "statistics.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

struct Options {
  std::uint32_t domain = 145;
  std::uint32_t beacons = 50;
  bool subscribers = true;
  int rounds = 5;
  double round_s = 4.0;
  std::vector<std::string> relay;
};

/// Returns the CPU share of a newly started process, after it has found the others.
double share_of(const Child& process, const Options& options) {
  sleep_s(2.5);
  const std::int64_t cpu_before_ns = process.cpu_time_ns();
  const SteadyTime began = clocks::steady_now();
  sleep_s(options.round_s);
  const std::int64_t cpu_after_ns = process.cpu_time_ns();
  return seconds_between(cpu_before_ns, cpu_after_ns) / seconds_between(began, clocks::steady_now());
}

void measure(const Options& options) {
  const std::string domain = std::to_string(options.domain);
  const Child fusion = Child::execute({SONOPOSE_FUSION, "--domain", domain});
  const Child bridge = Child::execute(
      {SONOPOSE_BRIDGE, "--domain", domain, "--address", std::to_string(first_relayed_address), "--beacons",
       std::to_string(options.beacons), "--imu-rate", fmt::format("{}", beacon_imu_rate_hz)});
  std::vector<Child> consumers;
  if (options.subscribers) {
    consumers.push_back(Child::fork_to([&] { consume_relayed(options.domain, options.beacons); }));
  }
  sleep_s(1.0);
  std::vector<std::string> relay{SONOPOSE_ROS2, "--domain",    domain, "--network",
                                 "loopback",    "--tf-static", "off"};
  if (options.beacons > 1)
    relay.insert(relay.end(), {"--base-frame", "b{address}", "--imu-frame", "i{address}"});
  relay.insert(relay.end(), options.relay.begin(), options.relay.end());
  std::vector<double> relay_shares;
  std::vector<double> bare_shares;
  std::vector<double> ratios;
  for (int round = 0; round < options.rounds; ++round) {
    {
      const Child process = Child::execute(relay);
      relay_shares.push_back(share_of(process, options));
    }
    const Child process = Child::fork_to([&] { relay_bare(options.domain, options.beacons); });
    bare_shares.push_back(share_of(process, options));
    ratios.push_back(relay_shares.back() / bare_shares.back());
  }
  fmt::print("{} interleaved rounds of {} s, {} beacons at {:.0f} Hz, {}; medians\n", options.rounds,
             options.round_s, options.beacons, beacon_imu_rate_hz,
             options.subscribers ? "a subscriber of every topic" : "no subscriber");
  fmt::print("relay CPU {:.1f} %, bare Cyclone DDS {:.1f} %, ratio {:.2f}\n", 100 * median(relay_shares),
             100 * median(bare_shares), median(ratios));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("The CPU time of the ROS 2 relay, and of bare Cyclone DDS.", "benchmark_relay");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Number of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_flag("!--no-subscribers", options.subscribers, "Nobody subscribes to the messages");
  app.add_option("--rounds", options.rounds, "Rounds of each process")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("relay", options.relay, "Arguments of the relay, after --");
  return run_main(app, argc, argv, [&] { measure(options); });
}
