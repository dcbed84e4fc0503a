#include "case_options.hpp"

namespace sonopose::apps {

void add_case_options(CLI::App& app, CaseOptions& options) {
  app.add_option("SCENARIO", options.scenarios, "Scenarios to score (default: all but the harder ones)")
      ->type_name("");
  app.add_flag("--harder", options.harder,
               "Score the harder scenarios, which differ from run to run, and SCENARIO if any");
  app.add_option("--seeds", options.seeds, "Number of runs of each scenario")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "Seed of the first run; another seed gives other runs")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  app.add_option("--recordings", options.recordings,
                 "Also score every sensor-log folder with truth in this folder")
      ->type_name("DIR")
      ->envname("SONOPOSE_RECORDINGS");
}

void for_each_case(const CaseOptions& options,
                   const std::function<void(std::vector<evaluation::Case>)>& use) {
  std::vector<const sim::Scenario*> chosen;
  for (const std::string& name : options.scenarios) chosen.push_back(&sim::find_scenario(name));
  if (options.harder) {
    for (const sim::Scenario& scenario : sim::harder_scenarios()) chosen.push_back(&scenario);
  }
  if (chosen.empty()) {
    for (const sim::Scenario& scenario : sim::scenarios()) chosen.push_back(&scenario);
  }
  for (const sim::Scenario* scenario : chosen) {
    std::vector<evaluation::Case> runs;
    for (std::uint64_t run = 0; run < options.seeds; ++run) {
      runs.push_back(evaluation::simulated_case(*scenario, options.first_seed + run));
    }
    use(std::move(runs));
  }
  if (!options.recordings) return;
  for (const std::filesystem::path& folder : evaluation::recordings_with_truth(*options.recordings)) {
    use({evaluation::recorded_case(folder)});
  }
}

}  // namespace sonopose::apps
