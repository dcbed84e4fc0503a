// Measures many beacons through one bridge, fusion and consumer: throughput, CPU cost, and the cost of a
// sample by the number of beacons. Rounds of all numbers are interleaved.

#include "beacons_round.hpp"
#include "child.hpp"
#include "process/stop_signal.hpp"
#include "statistics.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

struct Options : BeaconsOptions {
  std::vector<std::uint32_t> beacons{1, 10, 50, 100, 250};
  std::vector<std::string> engines{"bare", "documented", "kalman"};
  int rounds = 5;
};

using Rounds = std::vector<BeaconsRound>;

template <class Part>
double median_of(const Rounds& rounds, const Part& part) {
  std::vector<double> values;
  for (const BeaconsRound& round : rounds) values.push_back(part(round));
  return median(values);
}

/// The number of beacons and the engine.
using Case = std::pair<std::uint32_t, std::string>;

/// Returns the median ratio of the cost per sample over the rounds; `-` if the reference was not measured.
std::string cost_ratio(const std::map<Case, Rounds>& all, const Case& of, const Case& reference) {
  const auto found = all.find(reference);
  if (found == all.end()) return "-";
  std::vector<double> ratios;
  for (std::size_t i = 0; i < found->second.size(); ++i) {
    ratios.push_back(all.at(of)[i].fusion_per_sample_s / found->second[i].fusion_per_sample_s);
  }
  return fmt::format("{:.2f}", median(ratios));
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

void print_table(const Options& options, const std::map<Case, Rounds>& all) {
  fmt::print("{} interleaved rounds of {} s, {:.0f} Hz each, {}; medians; lost and missing are sums\n",
             options.rounds, options.round_s, beacon_imu_rate_hz,
             options.share ? "two fusions share the beacons" : "one fusion");
  fmt::print(
      "beacons  engine      poses/s  lost  missing  fusion CPU  most of one  us/sample  of 1's  of bare"
      "  of documented  memory MB  bridge CPU  p50 us  p99 us\n");
  for (const auto& [which, rounds] : all) {
    const auto& [beacons, engine] = which;
    double lost = 0.0;
    double missing = 0.0;
    for (const BeaconsRound& round : rounds) {
      lost += round.lost;
      missing += round.missing;
    }
    const auto max_cpu_share = [](const BeaconsRound& round) {
      return *std::max_element(round.fusion_shares.begin(), round.fusion_shares.end());
    };
    fmt::print(
        "{:>7}  {:<10} {:>8.0f} {:>5.0f} {:>8.0f} {:>9.1f} % {:>10.1f} % {:>10.1f} {:>7} {:>8} {:>14} "
        "{:>10.0f} {:>9.1f} % {:>7.0f} {:>7.0f}\n",
        beacons, engine, median_of(rounds, [](const BeaconsRound& round) { return round.poses_hz; }), lost,
        missing,
        100.0 * median_of(rounds, [](const BeaconsRound& round) { return sum(round.fusion_shares); }),
        100.0 * median_of(rounds, max_cpu_share),
        1e6 * median_of(rounds, [](const BeaconsRound& round) { return round.fusion_per_sample_s; }),
        cost_ratio(all, which, {1, engine}), cost_ratio(all, which, {beacons, "bare"}),
        cost_ratio(all, which, {beacons, "documented"}),
        1e-6 * median_of(rounds, [](const BeaconsRound& round) { return round.fusion_memory_bytes; }),
        100.0 * median_of(rounds, [](const BeaconsRound& round) { return round.bridge_share; }),
        1e6 * median_of(rounds, [](const BeaconsRound& round) { return round.p50_s; }),
        1e6 * median_of(rounds, [](const BeaconsRound& round) { return round.p99_s; }));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Many beacons through one bridge, fusion and consumer.", "benchmark_beacons");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Numbers of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_option("--engines", options.engines, "Engines of the fusion; bare: a relay without one")
      ->check(CLI::IsMember({"bare", "documented", "kalman"}))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds of each number")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--share", options.share, "Two fusion processes, each with half of the addresses");
  app.add_flag("--realtime", options.realtime, "--realtime for bridge and fusion, the same for the consumer");
  return run_main(app, argc, argv, [&] {
    process::StopSignal stop;
    stop.listen_to_signals();
    std::map<Case, Rounds> all;
    for (int round = 0; round < options.rounds && !stop.requested(); ++round) {
      for (const std::uint32_t beacons : options.beacons) {
        for (const std::string& engine : options.engines) {
          options.engine = engine;
          all[{beacons, engine}].push_back(measure_beacons(options, beacons));
        }
      }
    }
    print_table(options, all);
  });
}
