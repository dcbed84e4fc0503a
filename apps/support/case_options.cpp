#include "case_options.hpp"

#include "bag_options.hpp"
#include "bus_log/recording_files.hpp"
#include "config_options.hpp"
#include "expanded_option.hpp"
#include "installation_warning.hpp"
#include "logging/log.hpp"
#include "run.hpp"
#include "sim/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace sonopose::apps {

void add_case_options(CommandLine& app, CaseOptions& options) {
  app.add_option(
         "CASE", options.named,
         "Scenarios, and recordings: folders or MCAP files; NAME_001.mcap, NAME_002.mcap, ... are one "
         "(default: all scenarios but the harder ones)")
      .type_name("");
  add_expanded_option(app);
  add_bag_options(app);
  app.add_flag("--harder", options.harder,
               "Score the harder scenarios, which differ from run to run, and CASE if any");
  app.add_option("--seeds", options.seeds, "Number of runs of each scenario")
      .check(number_between(1, 1000))
      .capture_default_str();
  app.add_option("--first-seed", options.first_seed, "Seed of the first run; another seed gives other runs")
      .check(number_between(0, 1e9))
      .capture_default_str();
  app.add_option("--recordings", options.recordings, "Also score every recording in this folder")
      .type_name("DIR")
      .envname("SONOPOSE_RECORDINGS");
  add_beacon_option(app, options.beacon);
  app.option("--beacon").each([&options](const std::string&) { options.is_beacon_given = true; });
}

namespace {

void report_left_out(const std::string& what) {
  logging::warning("left out: " + what);
}

/// Files of a recording.
using Recording = std::vector<std::filesystem::path>;

/// Returns the number of a file of the recorder, 12 of NAME_012.mcap, and sets `name` to NAME.
std::optional<unsigned> number_of(const std::filesystem::path& file, std::string& name) {
  const std::string stem = file.stem().string();
  const std::size_t at = stem.rfind('_');
  if (at == std::string::npos) return std::nullopt;
  unsigned number = 0;
  const char* const end = stem.data() + stem.size();
  const auto read = std::from_chars(stem.data() + at + 1, end, number);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  name = stem.substr(0, at);
  return number;
}

/// Returns true if the recorder has written this file after the other one.
bool is_next(const std::filesystem::path& file, const std::filesystem::path& before) {
  std::string name;
  std::string name_before;
  const auto number = number_of(file, name);
  const auto number_before = number_of(before, name_before);
  return number && number_before && *number > *number_before && name == name_before &&
         file.parent_path() == before.parent_path() && file.extension() == before.extension();
}

/// Adds a file or a folder of MCAP files.
void add_recording(const std::filesystem::path& path, std::vector<Recording>& recordings) {
  if (!recordings.empty() && is_next(path, recordings.back().back())) {
    recordings.back().push_back(path);
  } else {
    recordings.push_back({path});
  }
}

/// Adds the recordings in a folder that are not in the list yet. Reports those that are left out.
void add_recordings(const std::filesystem::path& folder, std::vector<Recording>& recordings) {
  const evaluation::FoundRecordings found = evaluation::recordings_in(folder);
  for (const std::string& text : found.left_out) report_left_out(text);
  if (found.folders.empty()) {
    throw files::IoError(folder.string() + ": has no recording with imu.csv and ultrasonic.csv");
  }
  for (const std::filesystem::path& recording : found.folders) {
    const bool is_known =
        std::any_of(recordings.begin(), recordings.end(),
                    [&recording](const Recording& known) { return equivalent(known.front(), recording); });
    if (!is_known) recordings.push_back({recording});
  }
}

bool is_scenario(const std::string& name) {
  const auto has_name = [&name](const sim::Scenario& scenario) { return scenario.name == name; };
  return std::any_of(sim::scenarios().begin(), sim::scenarios().end(), has_name) ||
         std::any_of(sim::harder_scenarios().begin(), sim::harder_scenarios().end(), has_name) ||
         std::any_of(sim::violations().begin(), sim::violations().end(), has_name);
}

/// Returns false for a recording that was found in a folder.
bool is_named(const std::filesystem::path& recording, const CaseOptions& options) {
  return std::any_of(options.named.begin(), options.named.end(), [&recording](const std::string& name) {
    std::error_code error;
    return recording == name || std::filesystem::equivalent(recording, name, error);
  });
}

const sim::Scenario& scenario_named(const std::string& name) {
  try {
    return sim::find_scenario(name);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: no such folder, and {}", name, error.what()));
  }
}

/// Scenarios and recordings, in the order of their run.
struct Chosen {
  std::vector<const sim::Scenario*> scenarios;
  std::vector<Recording> recordings;
};

void append(std::span<const sim::Scenario> all, std::vector<const sim::Scenario*>& scenarios) {
  for (const sim::Scenario& scenario : all) scenarios.push_back(&scenario);
}

Chosen chosen_by(const CaseOptions& options) {
  Chosen chosen;
  for (const std::string& name : options.named) {
    // A folder with the name of a scenario needs a slash: ./walk.
    if (!is_scenario(name) && !bus_log::is_log_folder(name)) {
      add_recording(name, chosen.recordings);
    } else if (!is_scenario(name) && std::filesystem::exists(name)) {
      add_recordings(name, chosen.recordings);
    } else {
      chosen.scenarios.push_back(&scenario_named(name));
    }
  }
  if (options.harder) {
    append(sim::harder_scenarios(), chosen.scenarios);
    append(sim::violations(), chosen.scenarios);
  }
  if (chosen.scenarios.empty() && chosen.recordings.empty()) append(sim::scenarios(), chosen.scenarios);
  if (options.recordings) add_recordings(*options.recordings, chosen.recordings);
  return chosen;
}

CasePlace place_before(const Chosen& chosen) {
  CasePlace place;
  place.count = chosen.scenarios.size() + chosen.recordings.size();
  for (const sim::Scenario* scenario : chosen.scenarios) {
    place.name_columns = std::max(place.name_columns, scenario->name.size());
  }
  for (const Recording& recording : chosen.recordings) {
    place.name_columns = std::max(place.name_columns, bus_log::name_of(recording).size());
  }
  return place;
}

}  // namespace

std::size_t for_each_case(const CaseOptions& options, const settings::Settings& settings,
                          const std::function<void(std::vector<evaluation::Case>)>& use,
                          const std::function<void(const CasePlace&)>& begin) {
  const Chosen chosen = chosen_by(options);
  CasePlace place = place_before(chosen);
  const auto begin_case = [&](std::string name) {
    place.name = std::move(name);
    if (begin) begin(place);
    ++place.index;
  };
  for (const sim::Scenario* scenario : chosen.scenarios) {
    begin_case(std::string(scenario->name));
    std::vector<evaluation::Case> runs;
    for (std::uint64_t run = 0; run < options.seeds; ++run) {
      runs.push_back(evaluation::simulated_case(*scenario, options.first_seed + run));
    }
    use(std::move(runs));
  }
  const auto beacon = options.is_beacon_given ? std::optional(options.beacon) : std::nullopt;
  std::size_t unreadable = 0;
  std::size_t named_unreadable = 0;
  for (const Recording& recording : chosen.recordings) {
    begin_case(bus_log::name_of(recording));
    std::vector<evaluation::Case> runs;
    try {
      runs.push_back(evaluation::recorded_case(recording, beacon));
    } catch (const files::IoError& error) {
      report_left_out(error.what());
      ++unreadable;
      if (is_named(recording.front(), options)) ++named_unreadable;
      continue;
    }
    Warnings warnings;
    warn_of_installation(runs.front().name, runs.front().events, settings, installation::Search::brief,
                         warnings);
    use(std::move(runs));
  }
  if (chosen.scenarios.empty() && unreadable == chosen.recordings.size())
    throw files::IoError("no recording can be read");
  return named_unreadable;
}

bool is_left_out(const std::vector<evaluation::CaseResult>& runs, std::size_t& count) {
  const std::string& fault = runs.front().fix_fault;
  if (fault.empty()) return false;
  report_left_out(fmt::format("{}: {}", runs.front().name, fault));
  ++count;
  return true;
}

}  // namespace sonopose::apps
