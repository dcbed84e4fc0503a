#pragma once
// What the programs that score have in common: which cases.

#include "evaluation/cases.hpp"

#include <CLI/CLI.hpp>

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
  std::optional<BeaconAddress> beacon;  ///< of the files that have several
};

/// Adds CASE..., --harder, --seeds, --first-seed and --recordings.
void add_case_options(CLI::App& app, CaseOptions& options);

/// One of the cases, before it is made.
struct CasePlace {
  std::string name;
  std::size_t index = 0;
  std::size_t count = 0;         ///< of all cases
  std::size_t name_columns = 0;  ///< the length of the longest name of all
};

/// Calls `begin(place)` and then `use(runs)` with the runs of one scenario after the other, then with each
/// recording. Reports on standard error which recordings are left out. Throws std::invalid_argument for a
/// name that is neither a scenario nor a folder, files::IoError.
void for_each_case(const CaseOptions& options, const std::function<void(std::vector<evaluation::Case>)>& use,
                   const std::function<void(const CasePlace&)>& begin = {});

}  // namespace sonopose::apps
