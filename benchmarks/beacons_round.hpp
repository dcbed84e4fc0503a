#pragma once
// One bridge with many beacons → one or two fusions → one consumer, which is this process.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::benchmarks {

inline constexpr double beacon_imu_rate_hz = 100.0;

struct BeaconsOptions {
  std::uint32_t domain = 144;
  double round_s = 4.0;
  std::string engine;     ///< fusion.engine; `bare`: a relay of IMU samples in Cyclone's C API instead
  bool share = false;     ///< two fusions, each with half of the addresses
  bool realtime = false;  ///< --realtime for bridge and fusion, and real-time scheduling for the consumer
};

struct BeaconsRound {
  double poses_hz = 0;
  double lost = 0;                    ///< events lost by the fusion
  double missing = 0;                 ///< poses that did not reach the consumer
  std::vector<double> fusion_shares;  ///< CPU share of each fusion process, in cores
  double fusion_per_sample_s = 0;     ///< CPU time of all fusion processes
  double fusion_memory_bytes = 0;     ///< resident memory of the largest fusion process
  double bridge_share = 0;
  double p50_s = 0;
  double p99_s = 0;
};

/// Waits until all beacons have poses, then measures. Throws std::runtime_error after a timeout.
BeaconsRound measure_beacons(const BeaconsOptions& options, std::uint32_t beacons);

}  // namespace sonopose::benchmarks
