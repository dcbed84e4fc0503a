#pragma once
/// \file
/// Sources that are no hardware: the simulator and sensor-log folders.

#include <sonopose/samples/samples.hpp>
#include "bridge/pacer.hpp"
#include "bridge/source.hpp"
#include "sim/simulator.hpp"

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
  std::uint32_t beacons =
      1;                  ///< so many, with addresses and seeds from these on, each one higher than the last
  double duration_s = 0;  ///< 0: without end
  double rate = 1;
  std::optional<double> imu_rate_hz;             ///< empty: the scenario's
  std::optional<std::filesystem::path> capture;  ///< keep the bytes that a real beacon would have sent
};

/// The most beacons that one simulator source brings.
inline constexpr std::uint32_t max_simulated_beacons = 1000;

/// The built-in simulator, from the start of its run on. The IMU samples of several beacons are spread evenly
/// over the IMU's period. Throws std::invalid_argument for an unknown scenario, a number of beacons outside
/// 1…1000, addresses that no beacon can have, and a capture of several beacons.
std::unique_ptr<Source> make_simulator_source(const SimulatorOptions& options);

struct LogOptions {
  std::filesystem::path folder;
  BeaconAddress address = 7;
  double rate = 1;
  bool restamp = false;  ///< shift the stamps so that the recording begins now
};

/// A sensor-log folder, with its truth where it has one. Throws io::LogError.
std::unique_ptr<Source> make_log_source(const LogOptions& options);

}  // namespace sonopose::bridge
