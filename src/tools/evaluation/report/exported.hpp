#pragma once
/// \file
/// Exports a recording of the bus to files for other tools.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::evaluation {

struct ExportResult {
  std::uint64_t events = 0;
  std::uint64_t misread = 0;  ///< events whose meaning the log folder does not have
  std::uint64_t poses = 0;
  std::uint64_t reports = 0;
};

/// Writes one beacon of a recording, MCAP files or folders of them, to a new folder. It contains a sensor log
/// (imu.csv and truth.csv have EuRoC's columns), and recorded poses and reports like a replay:
/// trajectory.tum, pose.csv, fixes.csv. Throws files::IoError.
ExportResult export_recording(const std::vector<std::filesystem::path>& paths,
                              std::optional<BeaconAddress> address, const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
