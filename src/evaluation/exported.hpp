#pragma once
/// \file
/// A recording of the bus as files that other tools read.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace sonopose::evaluation {

struct ExportResult {
  std::uint64_t events = 0;
  std::uint64_t poses = 0;
  std::uint64_t reports = 0;
};

/// Writes one beacon of an MCAP file to a new folder: a sensor log (imu.csv and truth.csv have EuRoC's
/// columns), and of the recorded poses and reports what a replay writes too: trajectory.tum, pose.csv,
/// fixes.csv. Throws files::IoError.
ExportResult export_recording(const std::filesystem::path& file, std::optional<BeaconAddress> address,
                              const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
