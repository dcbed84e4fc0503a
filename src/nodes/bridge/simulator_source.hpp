#pragma once
/// \file
/// The built-in simulator as a source.

#include "publication/source.hpp"

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
  std::uint32_t beacons = 1;            ///< number of beacons; further ones take the next addresses and seeds
  double duration_s = 0;                ///< 0: unlimited
  double rate = 1;                      ///< playback speed (Pacer); 1: real time
  std::optional<double> imu_rate_hz;    ///< empty: rate of the scenario
  std::optional<double> wheel_rate_hz;  ///< rate of the speed of wheels; empty: that of the scenario
  std::optional<std::filesystem::path> capture;  ///< file for the bytes that a real beacon would have sent
};

/// Largest number of beacons of one simulator source.
inline constexpr std::uint32_t max_simulated_beacons = 1000;

/// A scenario from its start. The IMU samples of several beacons are spread evenly over the IMU's period.
/// Throws std::invalid_argument for an unknown scenario, a number of beacons outside 1…1000, addresses out of
/// range, and a capture of several beacons.
std::unique_ptr<publication::Source> make_simulator_source(const SimulatorOptions& options);

}  // namespace sonopose::bridge
