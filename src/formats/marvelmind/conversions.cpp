#include "marvelmind/conversions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace sonopose::marvelmind {

namespace {

constexpr double m_per_mm = 1e-3;
constexpr double s_per_ms = 1e-3;
constexpr double rad_per_decideg = std::numbers::pi / 1800;

const Vector3d compass_t_per_lsb{compass_xy_t_per_lsb, compass_xy_t_per_lsb, compass_z_t_per_lsb};

constexpr std::array<std::pair<PositionFlag, UltrasonicFlag>, 4> same_flags{{
    {position_user_button_1, ultrasonic_flag_user_button_1},
    {position_user_button_2, ultrasonic_flag_user_button_2},
    {position_other_hedge, ultrasonic_flag_other_hedge},
    {position_out_of_geofence, ultrasonic_flag_out_of_geofence},
}};

template <typename Integer>
Vector3d to_vector(const std::array<Integer, 3>& values) {
  return Eigen::Map<const Eigen::Matrix<Integer, 3, 1>>(values.data()).template cast<double>();
}

/// Rounds to nearest and clamps to the wire's type; NaN becomes zero.
template <typename Integer>
Integer to_wire(double value) {
  using Limits = std::numeric_limits<Integer>;
  if (std::isnan(value)) return 0;
  const auto lowest = static_cast<double>(Limits::min());
  const auto highest = static_cast<double>(Limits::max());
  return static_cast<Integer>(std::llround(std::clamp(value, lowest, highest)));
}

template <typename Integer>
std::array<Integer, 3> to_wire(const Vector3d& values) {
  return {to_wire<Integer>(values.x()), to_wire<Integer>(values.y()), to_wire<Integer>(values.z())};
}

std::uint32_t fix_flags(const Position& position) {
  std::uint32_t flags = 0;
  for (const auto& [wire, native] : same_flags) {
    if ((position.flags & wire) != 0) flags |= native;
  }
  if (position.angle.is_pair_centre()) flags |= ultrasonic_flag_pair_centre;
  if (position.time.base == TimeBase::uptime_64ths) flags |= ultrasonic_flag_second_resolution;
  return flags;
}

std::uint16_t angle_word(const UltrasonicFix& fix, const PairHeading* heading) {
  unsigned word = (fix.flags & ultrasonic_flag_pair_centre) != 0 ? PairAngle::pair_centre : 0U;
  if (heading == nullptr || !heading->valid || !std::isfinite(heading->heading_world_rad)) {
    return static_cast<std::uint16_t>(word | PairAngle::not_applicable);
  }
  const double turns = heading->heading_world_rad / (2 * std::numbers::pi);
  const double decideg = std::round((turns - std::floor(turns)) * PairAngle::max_yaw_decideg);
  word |= static_cast<unsigned>(decideg) % PairAngle::max_yaw_decideg;
  return static_cast<std::uint16_t>(word);
}

}  // namespace

ImuSample to_imu_sample(const RawImu& imu, TimeNs sensor_time_ns) {
  ImuSample sample;
  sample.address = imu.address;
  sample.sensor_time_ns = sensor_time_ns;
  sample.specific_force_body_mps2 = to_vector(imu.accel) * accel_mps2_per_lsb;
  sample.angular_velocity_body_radps = to_vector(imu.gyro) * gyro_radps_per_lsb;
  const bool has_compass = (imu.flags & imu_compass_not_available) == 0 && imu.compass != Vector3i16{};
  if (has_compass) sample.magnetic_field_body_t = to_vector(imu.compass).cwiseProduct(compass_t_per_lsb);
  return sample;
}

UltrasonicFix to_fix(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns) {
  UltrasonicFix fix;
  fix.address = position.address;
  fix.emission_time_ns = emission_time_ns;
  fix.received_time_ns = received_time_ns;
  fix.position_world_m = to_vector(position.xyz_mm) * m_per_mm;
  if (position.time_passed_ms != 0) fix.measured_delay_s = position.time_passed_ms * s_per_ms;
  fix.flags = fix_flags(position);
  return fix;
}

PairHeading to_heading(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns) {
  PairHeading heading;
  heading.address = position.address;
  heading.emission_time_ns = emission_time_ns;
  heading.received_time_ns = received_time_ns;
  heading.valid =
      position.angle.is_applicable() && position.angle.yaw_decideg() <= PairAngle::max_yaw_decideg;
  if (heading.valid) heading.heading_world_rad = position.angle.yaw_decideg() * rad_per_decideg;
  return heading;
}

sonopose::StationaryBeacon to_stationary_beacon(const StationaryBeacon& beacon, TimeNs received_time_ns) {
  sonopose::StationaryBeacon sample;
  sample.address = beacon.address;
  sample.time_ns = received_time_ns;
  if (beacon.location_available) sample.position_world_m = to_vector(beacon.xyz_mm) * m_per_mm;
  return sample;
}

RawImu to_raw_imu(const ImuSample& sample, const Stamp& time) {
  RawImu imu;
  imu.address = static_cast<std::uint8_t>(sample.address);
  imu.time = time;
  imu.accel = to_wire<std::int16_t>(sample.specific_force_body_mps2 / accel_mps2_per_lsb);
  imu.gyro = to_wire<std::int16_t>(sample.angular_velocity_body_radps / gyro_radps_per_lsb);
  if (sample.magnetic_field_body_t) {
    imu.compass = to_wire<std::int16_t>(sample.magnetic_field_body_t->cwiseQuotient(compass_t_per_lsb));
  } else {
    imu.flags = imu_compass_not_available;
  }
  return imu;
}

Position to_position(const UltrasonicFix& fix, const PairHeading* heading, const Stamp& emission) {
  Position position;
  position.time = emission;
  position.xyz_mm = to_wire<std::int32_t>(fix.position_world_m / m_per_mm);
  position.flags = position_time_in_ms;
  if (emission.base == TimeBase::uptime_64ths) position.flags = 0;
  for (const auto& [wire, native] : same_flags) {
    if ((fix.flags & native) != 0) position.flags |= wire;
  }
  position.address = static_cast<std::uint8_t>(fix.address);
  position.angle.word = angle_word(fix, heading);
  position.time_passed_ms = to_wire<std::uint16_t>(fix.measured_delay_s.value_or(0) / s_per_ms);
  return position;
}

std::optional<Quality> to_quality(const UltrasonicFix& fix) {
  if (!fix.quality_percent) return std::nullopt;
  const double percent = std::clamp(*fix.quality_percent, 0.0, 100.0);
  return Quality{static_cast<std::uint8_t>(fix.address), to_wire<std::uint8_t>(percent), 0};
}

}  // namespace sonopose::marvelmind
