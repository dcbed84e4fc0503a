#pragma once
// One bridge with many beacons → one fusion or two → one consumer, which is this process.

#include <cstdint>
#include <vector>

namespace sonopose::benchmarks {

inline constexpr double beacon_imu_rate_hz = 100.0;

struct BeaconsOptions {
  std::uint32_t domain = 144;
  double round_s = 4.0;
  bool share = false;     ///< two fusions, each with half of the addresses
  bool realtime = false;  ///< --realtime for bridge and fusion, the same for the consumer
};

/// What one round gave.
struct BeaconsRound {
  double poses_hz = 0;
  double lost = 0;                    ///< events that the fusion gave up
  double missing = 0;                 ///< poses that did not reach the consumer
  std::vector<double> fusion_shares;  ///< of a core, for each fusion process
  double fusion_per_sample_s = 0;     ///< of all fusion processes
  double bridge_share = 0;
  double p50_s = 0;
  double p99_s = 0;
};

/// Waits until all beacons have poses and measures. Throws std::runtime_error where they do not come.
BeaconsRound measure_beacons(const BeaconsOptions& options, std::uint32_t beacons);

}  // namespace sonopose::benchmarks
