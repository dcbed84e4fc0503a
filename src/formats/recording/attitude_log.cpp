#include "recording/attitude_log.hpp"

#include "csv/reader.hpp"
#include "files/missing.hpp"
#include "recording/input_check.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_files.hpp"

#include <utility>

namespace sonopose::recording {

AttitudeLog read_attitude_log(const std::filesystem::path& folder, std::optional<BeaconAddress> address) {
  ImuLog read = read_imu_log(folder, address);
  AttitudeLog log;
  log.imu = std::move(read.imu);
  log.warnings = std::move(read.warnings);
  if (log.imu.empty()) throw files::IoError((folder / imu_file).string() + ": no sample");
  if (files::is_present(folder / truth_file)) {
    log.truth = read_truth_csv(folder / truth_file, log.imu.front().address);
    sort_by_time(folder.string(), "true poses", log.truth, log.warnings);
  }
  if (files::is_present(folder / movement_file)) log.movements = read_movement_csv(folder / movement_file);
  return log;
}

std::vector<TimeSpan> read_movement_csv(const std::filesystem::path& file) {
  csv::Reader rows(file, layout_of(movement_columns, movement_columns.size()));
  std::vector<TimeSpan> spans;
  while (rows.next_row()) {
    TimeSpan& span = spans.emplace_back();
    span.start_ns = rows.time_ns(0);
    span.end_ns = rows.time_ns(1);
    if (span.end_ns < span.start_ns) rows.fail(1, "is before the start");
  }
  if (spans.empty()) throw files::IoError(file.string() + ": no span");
  return spans;
}

}  // namespace sonopose::recording
