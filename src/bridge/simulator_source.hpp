#pragma once
/// \file
/// The built-in simulator as a source.

#include "bridge/source.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::bridge {

struct SimulatorOptions {
  std::string scenario = "walk";
  std::uint64_t seed = 1;
  BeaconAddress address = 7;
  std::uint32_t beacons = 1;                     ///< the further ones take the next addresses and seeds
  double duration_s = 0;                         ///< 0: unlimited
  double rate = 1;                               ///< of time: see Pacer
  std::optional<double> imu_rate_hz;             ///< empty: the scenario's
  std::optional<std::filesystem::path> capture;  ///< file for the bytes that a real beacon would have sent
};

/// The most beacons that one simulator source can have.
inline constexpr std::uint32_t max_simulated_beacons = 1000;

/// A scenario from its start. The IMU samples of several beacons are spread evenly over the IMU's period.
/// Throws std::invalid_argument for an unknown scenario, a number of beacons outside 1…1000, addresses out of
/// range, and a capture of several beacons.
std::unique_ptr<Source> make_simulator_source(const SimulatorOptions& options);

}  // namespace sonopose::bridge
