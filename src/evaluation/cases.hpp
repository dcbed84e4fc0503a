#pragma once
/// \file
/// What the fusion is scored on: runs of the simulator's scenarios, and recordings.

#include "recording/log_folder.hpp"
#include "sim/scenario.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Events, and the corresponding truth where it is known.
struct Case {
  std::string name;
  std::vector<Event> events;
  std::vector<TruthSample> truth;
  std::vector<recording::WheelSpeed> wheel_speeds;
  double score_after_s = 6;          ///< after the first event
  std::vector<sim::Outage> outages;  ///< scored separately, in addition to the overall error
  std::vector<sim::Relocation> relocations;
  std::vector<sim::Outage> without_good_fixes{};  ///< gaps of the fixes, and wrong tracks
};

/// One run of a scenario.
Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed);

/// A sensor-log folder or a file, named by its path. `beacon`: of a file with several. Throws files::IoError,
/// also if it has no samples.
Case recorded_case(const std::filesystem::path& recording, std::optional<BeaconAddress> beacon = {});

/// The recordings at or below a folder, in alphabetical order.
struct FoundRecordings {
  std::vector<std::filesystem::path> folders;
  std::vector<std::string> left_out;  ///< what looks like a recording and cannot be scored, and why
};

/// Throws files::IoError if `folder` is not a folder.
FoundRecordings recordings_in(const std::filesystem::path& folder);

}  // namespace sonopose::evaluation
