#include "recording/log_folder.hpp"

#include "files/missing.hpp"
#include "recording/imu_rows.hpp"
#include "recording/input_check.hpp"
#include "recording/log_files.hpp"
#include "recording/log_meta.hpp"
#include "recording/look_ahead.hpp"
#include "recording/merged_streams.hpp"
#include "recording/unread_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace sonopose::recording {
namespace {

/// Throws if the folder is no log but contains logs of several beacons.
void check_single(const std::filesystem::path& folder) {
  if (files::is_present(folder / imu_file)) return;
  std::vector<std::string> beacons;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::error_code not_accessible;
    if (exists(entry.path() / imu_file, not_accessible)) beacons.push_back(entry.path().filename().string());
  }
  if (beacons.empty()) return;
  std::sort(beacons.begin(), beacons.end());
  throw files::IoError(fmt::format("{}: has the logs of several beacons: {}; name one of them",
                                   folder.string(), fmt::join(beacons, ", ")));
}

/// Reads the metadata and sets the address that the samples get.
LogMeta meta_of(const std::filesystem::path& folder, std::optional<BeaconAddress> given_address) {
  files::require_folder(folder);
  check_single(folder);
  LogMeta meta = read_log_meta(folder);
  if (!meta.beacon_address) meta.beacon_address = default_log_address;
  if (given_address) meta.beacon_address = given_address;
  return meta;
}

}  // namespace

SensorLog read_sensor_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address) {
  const LogMeta meta = meta_of(folder, address);
  const BeaconAddress own_address = *meta.beacon_address;
  // Most events are IMU samples: merge each as soon as it is read instead of storing it twice.
  const auto open_imu = [&] { return ImuRows(folder / imu_file, own_address, meta.imu_meaning); };
  ImuRows imu = open_imu();
  const auto fixes = read_ultrasonic_csv(folder / ultrasonic_file, own_address);
  std::vector<PairHeading> headings;
  if (files::is_present(folder / heading_file))
    headings = read_heading_csv(folder / heading_file, own_address);
  std::vector<TwistSample> twists;
  if (files::is_present(folder / twist_file)) twists = read_twist_csv(folder / twist_file, own_address);
  SensorLog log =
      merged(folder.string(), std::move(imu), open_imu, Samples(fixes), Samples(headings), Samples(twists));
  log.address = own_address;
  std::ranges::move(unread_tables(folder), std::back_inserter(log.warnings));
  if (files::is_present(folder / truth_file)) {
    log.truth = read_truth_csv(folder / truth_file, log.address);
    sort_by_time(folder.string(), "true poses", log.truth, log.warnings);
    const bool has_position = std::ranges::any_of(
        log.truth, [](const TruthSample& truth) { return truth.position_world_m.allFinite(); });
    if (!has_position)
      log.warnings.push_back((folder / truth_file).string() + ": has no row with a position");
  }
  if (files::is_present(folder / wheel_speed_file)) {
    log.wheel_speeds = read_wheel_speed_csv(folder / wheel_speed_file);
    sort_by_time(folder.string(), "wheel speeds", log.wheel_speeds, log.warnings);
  }
  return log;
}

ImuLog read_imu_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address) {
  const LogMeta meta = meta_of(folder, address);
  LookAhead imu(ImuRows(folder / imu_file, *meta.beacon_address, meta.imu_meaning));
  ImuLog log;
  for (; imu.current() != nullptr; imu.step()) log.imu.push_back(*imu.current());
  log.warnings = input_findings(folder.string(), log.imu);
  for (std::string& warning : imu.warnings(folder.string())) log.warnings.push_back(std::move(warning));
  return log;
}

}  // namespace sonopose::recording
