#pragma once
// The choice of cases, common to all programs that score.

#include "command_line.hpp"
#include "evaluation/replay/cases.hpp"
#include "evaluation/replay/evaluation.hpp"
#include "recording/log_folder.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

/// Scenarios, each with some seeds, and recordings.
struct CaseOptions {
  std::vector<std::string> named;  ///< scenarios, and folders with recordings
  bool harder = false;             ///< the harder scenarios, in addition to the named cases
  std::uint64_t seeds = 5;
  std::uint64_t first_seed = 1;
  std::optional<std::filesystem::path> recordings;
  BeaconAddress beacon = recording::default_log_address;  ///< its own settings apply
  bool is_beacon_given = false;                           ///< it is read from files of several
};

/// Adds CASE..., --harder, --seeds, --first-seed, --recordings and --beacon.
void add_case_options(CommandLine& app, CaseOptions& options);

/// A case that is about to be created.
struct CasePlace {
  std::string name;
  std::size_t index = 0;
  std::size_t count = 0;         ///< number of all cases
  std::size_t name_columns = 0;  ///< length of the longest name
};

/// Calls `begin(place)` and then `use(runs)` with the runs of each scenario, then with each recording.
/// Reports recordings that are omitted, or contradict the settings, on standard error, and returns the number
/// of omitted ones that are named. Throws files::IoError, and std::invalid_argument for a name that is
/// neither a scenario nor a folder.
std::size_t for_each_case(const CaseOptions& options, const settings::Settings& settings,
                          const std::function<void(std::vector<evaluation::Case>)>& use,
                          const std::function<void(const CasePlace&)>& begin = {});

/// Reports a case of which no fix was used, and adds one to `count`. Returns false for others.
bool is_left_out(const std::vector<evaluation::CaseResult>& runs, std::size_t& count);

}  // namespace sonopose::apps
