// One bridge with many beacons → fusion → one consumer: what comes through, what it costs, and how the cost
// of a sample depends on the number of beacons. Rounds of all numbers are interleaved.

#include "child.hpp"
#include "own_realtime.hpp"
#include "pose_stream.hpp"
#include "statistics.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

constexpr std::uint32_t first_address = 7;
constexpr double imu_rate_hz = 100.0;

struct Options {
  std::uint32_t domain = 144;
  std::vector<std::uint32_t> beacons{1, 10, 50, 100, 250};
  int rounds = 5;
  double round_s = 4.0;
  bool share = false;
  bool realtime = false;
};

/// What one round gave.
struct Round {
  double poses_hz = 0;
  double lost = 0;                    ///< events that the fusion gave up
  double missing = 0;                 ///< poses that did not reach the consumer
  std::vector<double> fusion_shares;  ///< of a core, for each fusion process
  double fusion_per_sample_s = 0;     ///< of all fusion processes
  double bridge_share = 0;
  double p50_s = 0;
  double p99_s = 0;
};

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// One fusion for all, or two with half of the addresses each.
std::vector<Child> start_fusions(const Options& options, std::uint32_t beacons) {
  std::vector<std::string> command{SONOPOSE_FUSION, "--domain", std::to_string(options.domain)};
  if (options.realtime) command.emplace_back("--realtime");
  std::vector<Child> fusions;
  if (!options.share) {
    fusions.push_back(Child::execute(command));
    return fusions;
  }
  const std::uint32_t middle = first_address + (beacons + 1) / 2;
  const std::uint32_t end = first_address + beacons;
  for (const auto& [first, last] : {std::pair(first_address, middle - 1), std::pair(middle, end - 1)}) {
    if (first > last) continue;
    auto mine = command;
    mine.insert(mine.end(), {"--addresses", fmt::format("{}-{}", first, last)});
    fusions.push_back(Child::execute(mine));
  }
  return fusions;
}

Child start_bridge(const Options& options, std::uint32_t beacons) {
  std::vector<std::string> command{SONOPOSE_BRIDGE, "--domain", std::to_string(options.domain)};
  command.insert(command.end(), {"--address", std::to_string(first_address)});
  command.insert(command.end(), {"--beacons", std::to_string(beacons)});
  command.insert(command.end(), {"--imu-rate", fmt::format("{}", imu_rate_hz)});
  if (options.realtime) command.emplace_back("--realtime");
  return Child::execute(command);
}

void wait_for_all(PoseStream& poses, std::uint32_t beacons) {
  for (int tenths = 0; poses.beacons() < beacons; ++tenths) {
    if (tenths == 200) {
      throw std::runtime_error(fmt::format("{} of {} beacons have poses", poses.beacons(), beacons));
    }
    sleep_s(0.1);
  }
  sleep_s(1.5);  // until it runs evenly and every status has come once
}

Round measure(const Options& options, std::uint32_t beacons) {
  const std::vector<Child> fusions = start_fusions(options, beacons);
  const Child bridge = start_bridge(options, beacons);
  PoseStream poses(imu_rate_hz);
  LostEvents lost;
  const dds::DomainParticipant participant({options.domain, dds::Network::loopback});
  const dds::QosProvider qos;
  const auto status_reader = dds::make_reader(participant, qos, dds::topics::fusion_status, &lost);
  const auto pose_reader = dds::make_reader(participant, qos, dds::topics::pose, &poses);
  std::optional<OwnRealtime> own;
  if (options.realtime) own.emplace();
  wait_for_all(poses, beacons);

  std::vector<std::int64_t> fusion_before_ns;
  for (const Child& fusion : fusions) fusion_before_ns.push_back(fusion.cpu_time_ns());
  const std::int64_t bridge_before_ns = bridge.cpu_time_ns();
  const std::uint64_t lost_before = lost.sum();
  const TimeNs began_ns = nodes::steady_now_ns();
  poses.taken();
  sleep_s(options.round_s);
  const double length_s = seconds_between(began_ns, nodes::steady_now_ns());
  const PoseCount count = poses.taken();
  Round round;
  const auto samples = static_cast<double>(count.latencies_s.size());
  for (std::size_t i = 0; i < fusions.size(); ++i) {
    const double cpu_s = seconds_between(fusion_before_ns[i], fusions[i].cpu_time_ns());
    round.fusion_shares.push_back(cpu_s / length_s);
    round.fusion_per_sample_s += cpu_s / samples;
  }
  round.bridge_share = seconds_between(bridge_before_ns, bridge.cpu_time_ns()) / length_s;
  sleep_s(1.2);  // for the statuses of the round's last second
  round.lost = static_cast<double>(lost.sum() - lost_before);
  round.poses_hz = samples / length_s;
  round.missing = static_cast<double>(count.missing);
  round.p50_s = math::quantile(count.latencies_s, 0.5);
  round.p99_s = math::quantile(count.latencies_s, 0.99);
  return round;
}

template <class Part>
double median_of(const std::vector<Round>& rounds, const Part& part) {
  std::vector<double> values;
  for (const Round& round : rounds) values.push_back(part(round));
  return median(values);
}

/// The median of the rounds' own ratios of the cost per sample; `-` where the other number was not measured.
std::string cost_ratio(const std::map<std::uint32_t, std::vector<Round>>& all, std::uint32_t beacons,
                       std::uint32_t reference) {
  const auto found = all.find(reference);
  if (found == all.end()) return "-";
  std::vector<double> ratios;
  for (std::size_t i = 0; i < found->second.size(); ++i) {
    ratios.push_back(all.at(beacons)[i].fusion_per_sample_s / found->second[i].fusion_per_sample_s);
  }
  return fmt::format("{:.2f}", median(ratios));
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

void print_table(const Options& options, const std::map<std::uint32_t, std::vector<Round>>& all) {
  fmt::print("{} interleaved rounds of {} s, {:.0f} Hz each, {}; medians, lost and missing are sums\n",
             options.rounds, options.round_s, imu_rate_hz,
             options.share ? "two fusions share the beacons" : "one fusion");
  fmt::print(
      "beacons  poses/s  lost  missing  fusion CPU  most of one  us/sample  of 1's  of 10's  bridge CPU"
      "  p50 us  p99 us\n");
  for (const auto& [beacons, rounds] : all) {
    double lost = 0.0;
    double missing = 0.0;
    for (const Round& round : rounds) {
      lost += round.lost;
      missing += round.missing;
    }
    const auto most = [](const Round& round) {
      return *std::max_element(round.fusion_shares.begin(), round.fusion_shares.end());
    };
    fmt::print(
        "{:>7} {:>8.0f} {:>5.0f} {:>8.0f} {:>9.1f} % {:>10.1f} % {:>10.1f} {:>7} {:>8} {:>9.1f} % {:>7.0f} "
        "{:>7.0f}\n",
        beacons, median_of(rounds, [](const Round& round) { return round.poses_hz; }), lost, missing,
        100.0 * median_of(rounds, [](const Round& round) { return sum(round.fusion_shares); }),
        100.0 * median_of(rounds, most),
        1e6 * median_of(rounds, [](const Round& round) { return round.fusion_per_sample_s; }),
        cost_ratio(all, beacons, 1), cost_ratio(all, beacons, 10),
        100.0 * median_of(rounds, [](const Round& round) { return round.bridge_share; }),
        1e6 * median_of(rounds, [](const Round& round) { return round.p50_s; }),
        1e6 * median_of(rounds, [](const Round& round) { return round.p99_s; }));
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
  app.add_option("--rounds", options.rounds, "Rounds of each number")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--share", options.share, "Two fusion processes, each with half of the addresses");
  app.add_flag("--realtime", options.realtime, "--realtime for bridge and fusion, the same for the consumer");
  CLI11_PARSE(app, argc, argv);
  try {
    std::map<std::uint32_t, std::vector<Round>> all;
    for (int round = 0; round < options.rounds; ++round) {
      for (const std::uint32_t beacons : options.beacons) all[beacons].push_back(measure(options, beacons));
    }
    print_table(options, all);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_beacons: {}\n", error.what());
    return 1;
  }
  return 0;
}
