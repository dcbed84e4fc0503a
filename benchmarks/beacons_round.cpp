#include "beacons_round.hpp"

#include "bare_chain.hpp"
#include "child.hpp"
#include "own_realtime.hpp"
#include "pose_stream.hpp"
#include <sonopose/statistics/quantile.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace sonopose::benchmarks {
namespace {

constexpr std::uint32_t first_address = 7;

/// Starts one fusion for all beacons, two with half of the addresses each, or the bare minimum of a fusion.
std::vector<Child> start_fusions(const BeaconsOptions& options, std::uint32_t beacons) {
  std::vector<Child> fusions;
  if (options.engine == "bare") {
    fusions.push_back(Child::fork_to([&] { run_bare_relay(options.domain); }));
    return fusions;
  }
  std::vector<std::string> command{SONOPOSE_FUSION, "--domain", std::to_string(options.domain)};
  if (options.realtime) command.emplace_back("--realtime");
  if (!options.engine.empty()) command.insert(command.end(), {"--set", "fusion.engine=" + options.engine});
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

Child start_bridge(const BeaconsOptions& options, std::uint32_t beacons) {
  std::vector<std::string> command{SONOPOSE_BRIDGE, "--domain", std::to_string(options.domain)};
  command.insert(command.end(), {"--address", std::to_string(first_address)});
  command.insert(command.end(), {"--beacons", std::to_string(beacons)});
  command.insert(command.end(), {"--imu-rate", fmt::format("{}", beacon_imu_rate_hz)});
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
  sleep_s(1.5);  // lets the rate settle and every status arrive once
}

}  // namespace

BeaconsRound measure_beacons(const BeaconsOptions& options, std::uint32_t beacons) {
  const std::vector<Child> fusions = start_fusions(options, beacons);
  const Child bridge = start_bridge(options, beacons);
  PoseStream poses(beacon_imu_rate_hz);
  LostEvents lost;
  const auto participant = dds::ext::participant({options.domain, dds::Network::loopback});
  const dds::qos::Provider qos;
  const auto status_reader = dds::topics::make_reader(participant, qos, dds::topics::fusion_status, &lost);
  const auto pose_reader = dds::topics::make_reader(participant, qos, dds::topics::pose, &poses);
  std::optional<OwnRealtime> own;
  if (options.realtime) own.emplace();
  wait_for_all(poses, beacons);

  std::vector<std::int64_t> fusion_before_ns;
  for (const Child& fusion : fusions) fusion_before_ns.push_back(fusion.cpu_time_ns());
  const std::int64_t bridge_before_ns = bridge.cpu_time_ns();
  const std::uint64_t lost_before = lost.sum();
  const SteadyTime began = clocks::steady_now();
  poses.taken();
  sleep_s(options.round_s);
  const double length_s = seconds_between(began, clocks::steady_now());
  const PoseCount count = poses.taken();
  BeaconsRound round;
  const auto samples = static_cast<double>(count.latencies_s.size());
  for (std::size_t i = 0; i < fusions.size(); ++i) {
    const double cpu_s = seconds_between(fusion_before_ns[i], fusions[i].cpu_time_ns());
    round.fusion_shares.push_back(cpu_s / length_s);
    round.fusion_per_sample_s += cpu_s / samples;
    round.fusion_memory_bytes =
        std::max(round.fusion_memory_bytes, static_cast<double>(fusions[i].memory_bytes()));
  }
  round.bridge_share = seconds_between(bridge_before_ns, bridge.cpu_time_ns()) / length_s;
  sleep_s(1.2);  // lets the statuses of the round's last second arrive
  round.lost = static_cast<double>(lost.sum() - lost_before);
  round.poses_hz = samples / length_s;
  round.missing = static_cast<double>(count.missing);
  round.p50_s = statistics::quantile(count.latencies_s, 0.5);
  round.p99_s = statistics::quantile(count.latencies_s, 0.99);
  return round;
}

}  // namespace sonopose::benchmarks
