#include "recording/log_files.hpp"

#include "csv/reader.hpp"
#include "csv/units.hpp"
#include "recording/imu_rows.hpp"

#include <cmath>
#include <limits>

namespace sonopose::recording {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<ImuSample> read_imu_csv(const std::filesystem::path& file, BeaconAddress address) {
  return read_imu_table(file, address, imu_layout()).samples;
}

ImuTable read_imu_table(const std::filesystem::path& file, BeaconAddress address, const csv::Layout& layout) {
  ImuTable table;
  ImuRows rows(file, address, ImuMeaning::unknown, layout);
  for (; rows.current() != nullptr; rows.step()) table.samples.push_back(*rows.current());
  table.rows_without_values = rows.left_out();
  table.incomplete_rows = rows.incomplete();
  return table;
}

std::vector<UltrasonicFix> read_ultrasonic_csv(const std::filesystem::path& file, BeaconAddress address) {
  csv::Reader rows(file, layout_of(ultrasonic_columns, ultrasonic_columns_required));
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
  csv::Reader rows(file, layout_of(heading_columns, heading_columns.size()));
  std::vector<PairHeading> headings;
  while (rows.next_row()) {
    PairHeading& heading = headings.emplace_back();
    heading.address = address;
    heading.emission_time_ns = rows.time_ns(0);
    heading.received_time_ns = rows.time_ns(1);
    heading.valid = !rows.is_empty(2);
    if (heading.valid) heading.heading_world_rad = rows.number_in(csv::degree, 2);
  }
  return headings;
}

std::vector<TwistSample> read_twist_csv(const std::filesystem::path& file, BeaconAddress address) {
  csv::Reader rows(file, layout_of(twist_columns, twist_columns_required));
  std::vector<TwistSample> twists;
  while (rows.next_row()) {
    TwistSample& twist = twists.emplace_back();
    twist.address = address;
    twist.emission_time_ns = rows.time_ns(0);
    twist.received_time_ns = rows.time_ns(1);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      if (const auto velocity_mps = rows.optional_number(2 + i)) {
        twist.velocity_body_mps[axis] = *velocity_mps;
        twist.velocity_std_mps[axis] = rows.optional_number(5 + i).value_or(-1.0);
        twist.axes |= twist_velocity_x << i;
      }
      if (const auto rate_radps = rows.optional_number(8 + i)) {
        twist.angular_velocity_body_radps[axis] = *rate_radps;
        twist.axes |= twist_angular_velocity_x << i;
      }
    }
  }
  return twists;
}

std::vector<TruthSample> read_truth_csv(const std::filesystem::path& file, BeaconAddress address,
                                        const csv::Layout& layout) {
  csv::Reader rows(file, layout);
  std::vector<TruthSample> samples;
  while (rows.next_row()) {
    if (samples.empty()) samples.reserve(rows.rows_like_this());
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

std::vector<WheelSpeed> read_wheel_speed_csv(const std::filesystem::path& file) {
  csv::Reader rows(file, layout_of(wheel_speed_columns, wheel_speed_columns.size()));
  std::vector<WheelSpeed> speeds;
  while (rows.next_row()) {
    const auto speed_mps = rows.optional_number(1);
    if (speed_mps && std::isfinite(*speed_mps)) speeds.push_back({rows.time_ns(0), *speed_mps});
  }
  return speeds;
}

}  // namespace sonopose::recording
