#include "evaluation/replay/cases.hpp"

#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "files/missing.hpp"
#include "sim/simulator.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace sonopose::evaluation {

Case simulated_case(const sim::Scenario& scenario, std::uint64_t seed) {
  const sim::Run run{.seed = seed};
  const sim::Scenario drawn = sim::drawn(scenario, run);
  sim::Recording recording = sim::record(drawn, run);
  std::vector<sim::Outage> without_good_fixes = drawn.disturbances.outages;
  for (const sim::OutlierBurst& track : drawn.disturbances.outlier_bursts) {
    without_good_fixes.push_back({track.begin_s, track.duration_s});
  }
  for (const sim::FixFault& fault : drawn.disturbances.fix_faults) {
    if (fault.repeats) without_good_fixes.push_back({fault.begin_s, fault.duration_s});
  }
  return {.name = std::string(drawn.name),
          .events = std::move(recording.events),
          .truth = std::move(recording.truth),
          .wheel_speeds = {},
          .score_after_s = drawn.score_after_s,
          .outages = drawn.disturbances.outages,
          .relocations = drawn.disturbances.relocations,
          .without_good_fixes = std::move(without_good_fixes)};
}

Case recorded_case(const std::vector<std::filesystem::path>& recording, std::optional<BeaconAddress> beacon) {
  if (bus_log::is_log_folder(recording.front())) beacon.reset();
  sonopose::recording::SensorLog log = bus_log::read_sensor_log(recording, beacon);
  if (std::ranges::none_of(log.events,
                           [](const Event& event) { return std::holds_alternative<ImuSample>(event); })) {
    throw files::IoError(bus_log::name_of(recording) + ": has no IMU sample: there is nothing to fuse");
  }
  Case test_case;
  test_case.name = bus_log::name_of(recording);
  test_case.events = std::move(log.events);
  test_case.truth = std::move(log.truth);
  test_case.wheel_speeds = std::move(log.wheel_speeds);
  return test_case;
}

FoundRecordings recordings_in(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  files::require_folder(folder);
  FoundRecordings found;
  const auto consider = [&found](const fs::path& candidate) {
    const bool has_imu = files::is_present(candidate / "imu.csv");
    const bool has_fixes = files::is_present(candidate / "ultrasonic.csv");
    if (has_imu && has_fixes) found.folders.push_back(candidate);
    if (has_imu && !has_fixes) found.left_out.push_back(candidate.string() + ": has no ultrasonic.csv");
    if (!has_imu && has_fixes) found.left_out.push_back(candidate.string() + ": has no imu.csv");
  };
  consider(folder);
  for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator();
       ++entry) {
    if (!entry->is_directory()) continue;
    if (entry->path().extension() == ".part") {
      found.left_out.push_back(entry->path().string() + ": is not complete; name it to score it");
      entry.disable_recursion_pending();
    } else {
      consider(entry->path());
    }
  }
  std::sort(found.folders.begin(), found.folders.end());
  std::sort(found.left_out.begin(), found.left_out.end());
  return found;
}

}  // namespace sonopose::evaluation
