#pragma once
/// \file
/// Sources that are no hardware: the simulator and sensor-log folders.

#include <sonopose/core/samples.hpp>
#include <sonopose/nodes/pacer.hpp>
#include <sonopose/nodes/source.hpp>
#include <sonopose/sim/simulator.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::nodes {

struct SimulatorOptions {
  std::string scenario = "walk";
  std::uint64_t seed = 1;
  BeaconAddress address = 7;
  double duration_s = 0;  ///< 0: without end
  double rate = 1;
  std::optional<double> imu_rate_hz;             ///< empty: the scenario's
  std::optional<std::filesystem::path> capture;  ///< keep the bytes that a real beacon would have sent
};

/// The built-in simulator, from now on. Throws std::invalid_argument for an unknown scenario.
std::unique_ptr<Source> make_simulator_source(const SimulatorOptions& options);

struct LogOptions {
  std::filesystem::path folder;
  BeaconAddress address = 7;
  double rate = 1;
  bool restamp = false;  ///< shift the stamps so that the recording begins now
};

/// A sensor-log folder, with its truth where it has one. Throws io::LogError.
std::unique_ptr<Source> make_log_source(const LogOptions& options);

}  // namespace sonopose::nodes
