#include "csv_reader.hpp"
#include "log_columns.hpp"
#include "units.hpp"
#include <sonopose/io/log_folder.hpp>

#include <limits>

namespace sonopose::io {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SensorLog read_sensor_log(const std::filesystem::path& folder, BeaconAddress address) {
  if (!std::filesystem::is_directory(folder)) throw IoError(folder.string() + ": is not a folder");
  const auto imu = read_imu_csv(folder / imu_file, address);
  const auto fixes = read_ultrasonic_csv(folder / ultrasonic_file, address);
  std::vector<PairHeading> headings;
  if (exists(folder / heading_file)) headings = read_heading_csv(folder / heading_file, address);
  SensorLog log;
  if (exists(folder / truth_file)) log.truth = read_truth_csv(folder / truth_file, address);
  log.events = merge_by_availability(imu, fixes, headings);
  return log;
}

std::vector<Event> merge_by_availability(const std::vector<ImuSample>& imu,
                                         const std::vector<UltrasonicFix>& fixes,
                                         const std::vector<PairHeading>& headings) {
  std::vector<Event> events;
  events.reserve(imu.size() + fixes.size() + headings.size());
  const auto append = [&events](auto sample) {
    sample.sequence = events.size() + 1;
    events.emplace_back(sample);
  };
  constexpr TimeNs never = std::numeric_limits<TimeNs>::max();
  auto next_imu = imu.begin();
  auto next_fix = fixes.begin();
  auto next_heading = headings.begin();
  while (next_imu != imu.end() || next_fix != fixes.end() || next_heading != headings.end()) {
    const TimeNs imu_ns = next_imu != imu.end() ? next_imu->sensor_time_ns : never;
    const TimeNs fix_ns = next_fix != fixes.end() ? next_fix->received_time_ns : never;
    const TimeNs heading_ns = next_heading != headings.end() ? next_heading->received_time_ns : never;
    if (next_imu != imu.end() && imu_ns <= fix_ns && imu_ns <= heading_ns) {
      append(*next_imu++);
    } else if (next_fix != fixes.end() && fix_ns <= heading_ns) {
      append(*next_fix++);
    } else {
      append(*next_heading++);
    }
  }
  return events;
}

std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address) {
  CsvReader rows(file, {imu_columns, imu_columns_without_magnetometer});
  std::vector<ImuSample> samples;
  while (rows.next_row()) {
    ImuSample& sample = samples.emplace_back();
    sample.address = address;
    sample.sensor_time_ns = rows.time_ns(0);
    sample.angular_velocity_body_radps = rows.vector(1);
    sample.specific_force_body_mps2 = rows.vector(4);
    if (rows.all_filled(7, 3)) {
      sample.magnetic_field_body_t.emplace(rows.number_in(microtesla, 7), rows.number_in(microtesla, 8),
                                           rows.number_in(microtesla, 9));
    }
  }
  return samples;
}

std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address) {
  CsvReader rows(file, {ultrasonic_columns, ultrasonic_columns.size()});
  std::vector<UltrasonicFix> fixes;
  while (rows.next_row()) {
    UltrasonicFix& fix = fixes.emplace_back();
    fix.address = address;
    fix.emission_time_ns = rows.time_ns(0);
    fix.received_time_ns = rows.time_ns(1);
    fix.position_world_m = rows.vector(2);
    fix.quality_percent = rows.optional_number(5);
    fix.measured_delay_s = seconds_between(fix.emission_time_ns, fix.received_time_ns);
  }
  return fixes;
}

std::vector<PairHeading> read_heading_csv(const std::filesystem::path& file, BeaconAddress address) {
  CsvReader rows(file, {heading_columns, heading_columns.size()});
  std::vector<PairHeading> headings;
  while (rows.next_row()) {
    PairHeading& heading = headings.emplace_back();
    heading.address = address;
    heading.emission_time_ns = rows.time_ns(0);
    heading.received_time_ns = rows.time_ns(1);
    heading.valid = !rows.is_empty(2);
    if (heading.valid) heading.heading_world_rad = rows.number_in(degree, 2);
  }
  return headings;
}

std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address) {
  CsvReader rows(file, {truth_columns, truth_columns_least, true});
  std::vector<TruthSample> samples;
  while (rows.next_row()) {
    TruthSample& sample = samples.emplace_back();
    sample.address = address;
    sample.time_ns = rows.time_ns(0);
    const auto vector_or_unknown = [&rows](std::size_t column) -> Vector3d {
      return rows.all_filled(column, 3) ? rows.vector(column) : Vector3d::Constant(unknown);
    };
    sample.position_world_m = vector_or_unknown(1);
    sample.q_body_to_world = {unknown, unknown, unknown, unknown};
    if (rows.all_filled(4, 4)) {
      sample.q_body_to_world = {rows.number(4), rows.number(5), rows.number(6), rows.number(7)};
    }
    sample.velocity_world_mps = vector_or_unknown(8);
  }
  return samples;
}

}  // namespace sonopose::io
