#pragma once
/// \file
/// The data for scoring the fusion: runs of the simulator's scenarios, and recordings.

#include "recording/log_folder.hpp"
#include "sim/scenario.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Events, and the corresponding truth if it is known.
struct Case {
  std::string name;
  std::vector<Event> events;
  std::vector<TruthSample> truth;
  std::vector<recording::WheelSpeed> wheel_speeds;
  double score_after_s = 6;          ///< start of scoring after the first event
  std::vector<sim::Outage> outages;  ///< outages, scored separately in addition to the overall error
  std::vector<sim::Relocation> relocations;
  std::vector<sim::Outage> without_good_fixes{};  ///< gaps of the fixes, and wrong tracks
};

/// Creates one run of a scenario.
Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed);

/// Reads a recording, named by its path: a sensor-log folder, or MCAP files. `beacon` selects one of several.
/// Throws files::IoError, also if there are no samples.
Case recorded_case(const std::vector<std::filesystem::path>& recording,
                   std::optional<BeaconAddress> beacon = {});

/// The recordings in a folder and its subfolders, in alphabetical order.
struct FoundRecordings {
  std::vector<std::filesystem::path> folders;
  std::vector<std::string> left_out;  ///< apparent recordings that cannot be scored, with the reason
};

/// Throws files::IoError if `folder` is not a folder.
FoundRecordings recordings_in(const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
