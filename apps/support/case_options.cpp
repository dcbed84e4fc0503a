#include "case_options.hpp"

#include "sim/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace sonopose::apps {

void add_case_options(CLI::App& app, CaseOptions& options) {
  app.add_option("CASE", options.named,
                 "Scenarios, and folders with recordings (default: all scenarios but the harder ones)")
      ->type_name("");
  app.add_flag("--harder", options.harder,
               "Score the harder scenarios, which differ from run to run, and CASE if any");
  app.add_option("--seeds", options.seeds, "Number of runs of each scenario")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "Seed of the first run; another seed gives other runs")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  app.add_option("--recordings", options.recordings, "Also score every recording in this folder")
      ->type_name("DIR")
      ->envname("SONOPOSE_RECORDINGS");
}

namespace {

/// The recordings in a folder. Reports those that are left out.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder) {
  const evaluation::FoundRecordings found = evaluation::recordings_in(folder);
  for (const std::string& text : found.left_out) fmt::print(stderr, "left out: {}\n", text);
  if (found.folders.empty())
    throw files::IoError(folder.string() + ": has no recording with imu.csv and ultrasonic.csv");
  return found.folders;
}

bool is_scenario(const std::string& name) {
  const auto has_name = [&name](const sim::Scenario& scenario) { return scenario.name == name; };
  return std::any_of(sim::scenarios().begin(), sim::scenarios().end(), has_name) ||
         std::any_of(sim::harder_scenarios().begin(), sim::harder_scenarios().end(), has_name);
}

}  // namespace

void for_each_case(const CaseOptions& options,
                   const std::function<void(std::vector<evaluation::Case>)>& use) {
  std::vector<const sim::Scenario*> chosen;
  std::vector<std::filesystem::path> recordings;
  for (const std::string& name : options.named) {
    // A folder with the name of a scenario needs a slash: ./walk.
    if (!is_scenario(name) && std::filesystem::exists(name)) {
      for (auto& folder : recordings_in(name)) recordings.push_back(std::move(folder));
    } else {
      chosen.push_back(&sim::find_scenario(name));
    }
  }
  if (options.harder) {
    for (const sim::Scenario& scenario : sim::harder_scenarios()) chosen.push_back(&scenario);
  }
  if (chosen.empty() && recordings.empty()) {
    for (const sim::Scenario& scenario : sim::scenarios()) chosen.push_back(&scenario);
  }
  if (options.recordings) {
    for (auto& folder : recordings_in(*options.recordings)) recordings.push_back(std::move(folder));
  }
  for (const sim::Scenario* scenario : chosen) {
    std::vector<evaluation::Case> runs;
    for (std::uint64_t run = 0; run < options.seeds; ++run) {
      runs.push_back(evaluation::simulated_case(*scenario, options.first_seed + run));
    }
    use(std::move(runs));
  }
  for (const std::filesystem::path& folder : recordings) use({evaluation::recorded_case(folder)});
}

}  // namespace sonopose::apps
