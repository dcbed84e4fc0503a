#include <sonopose/dds/topics/conversions.hpp>

namespace sonopose::dds {
namespace {

// The bits mean the same on both sides, so that they can be copied as they are.
static_assert(all_beacons == sonopose_ALL_BEACONS);
static_assert(ultrasonic_flag_user_button_1 == sonopose_FIX_USER_BUTTON_1);
static_assert(ultrasonic_flag_user_button_2 == sonopose_FIX_USER_BUTTON_2);
static_assert(ultrasonic_flag_other_hedge == sonopose_FIX_OTHER_HEDGE);
static_assert(ultrasonic_flag_out_of_geofence == sonopose_FIX_OUT_OF_GEOFENCE);
static_assert(ultrasonic_flag_pair_centre == sonopose_FIX_PAIR_CENTRE);
static_assert(ultrasonic_flag_second_resolution == sonopose_FIX_SECOND_RESOLUTION);
static_assert(status_initialising == sonopose_STATUS_INITIALISING);
static_assert(status_uncalibrated == sonopose_STATUS_UNCALIBRATED);
static_assert(status_stale == sonopose_STATUS_STALE);
static_assert(status_converging == sonopose_STATUS_CONVERGING);
static_assert(status_heading_unknown == sonopose_STATUS_HEADING_UNKNOWN);
static_assert(status_frozen_track == sonopose_STATUS_FROZEN_TRACK);
static_assert(status_predicted == sonopose_STATUS_PREDICTED);
static_assert(status_imu_gap == sonopose_STATUS_IMU_GAP);
static_assert(status_low_trust == sonopose_STATUS_LOW_TRUST);
static_assert(status_rotating_fast == sonopose_STATUS_ROTATING_FAST);
static_assert(fix_used == sonopose_FIX_USED);
static_assert(fix_outlier == sonopose_FIX_OUTLIER);
static_assert(fix_low_quality == sonopose_FIX_LOW_QUALITY);
static_assert(fix_invalid == sonopose_FIX_INVALID);
static_assert(fix_stuck_forced == sonopose_FIX_STUCK_FORCED);
static_assert(fix_snapped_over == sonopose_FIX_SNAPPED_OVER);
static_assert(fix_snapped_under == sonopose_FIX_SNAPPED_UNDER);
static_assert(fix_stale_recovered == sonopose_FIX_STALE_RECOVERED);
static_assert(fix_frozen == sonopose_FIX_FROZEN);
static_assert(fix_first == sonopose_FIX_FIRST);

sonopose_Vector3 idl(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Vector3d native(const sonopose_Vector3& v) {
  return {v.x, v.y, v.z};
}

sonopose_Quaternion idl(const Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}
Quaterniond native(const sonopose_Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

constexpr float unknown_quality = -1.0F;

template <class T>
std::optional<T> if_valid(bool valid, const T& value) {
  return valid ? std::optional<T>(value) : std::nullopt;
}

}  // namespace

sonopose_ImuSample to_idl(const ImuSample& sample) {
  return {.address = sample.address,
          .event_sequence = sample.sequence,
          .sensor_time = sample.sensor_time_ns,
          .bridge_time = sample.bridge_time_ns,
          .angular_velocity = idl(sample.angular_velocity_body_radps),
          .specific_force = idl(sample.specific_force_body_mps2),
          .magnetic_field = idl(sample.magnetic_field_body_t.value_or(Vector3d::Zero())),
          .magnetic_field_valid = sample.magnetic_field_body_t.has_value()};
}

ImuSample from_idl(const sonopose_ImuSample& sample) {
  return {.address = sample.address,
          .sequence = sample.event_sequence,
          .sensor_time_ns = sample.sensor_time,
          .bridge_time_ns = sample.bridge_time,
          .angular_velocity_body_radps = native(sample.angular_velocity),
          .specific_force_body_mps2 = native(sample.specific_force),
          .magnetic_field_body_t = if_valid(sample.magnetic_field_valid, native(sample.magnetic_field))};
}

sonopose_UltrasonicFix to_idl(const UltrasonicFix& fix) {
  return {.address = fix.address,
          .event_sequence = fix.sequence,
          .emission_time = fix.emission_time_ns,
          .received_time = fix.received_time_ns,
          .position = idl(fix.position_world_m),
          .quality = fix.quality_percent ? static_cast<float>(*fix.quality_percent) : unknown_quality,
          .measured_delay = fix.measured_delay_s.value_or(0.0),
          .measured_delay_valid = fix.measured_delay_s.has_value(),
          .flags = fix.flags};
}

UltrasonicFix from_idl(const sonopose_UltrasonicFix& fix) {
  return {.address = fix.address,
          .sequence = fix.event_sequence,
          .emission_time_ns = fix.emission_time,
          .received_time_ns = fix.received_time,
          .position_world_m = native(fix.position),
          .quality_percent = if_valid(fix.quality >= 0.0F, static_cast<double>(fix.quality)),
          .measured_delay_s = if_valid(fix.measured_delay_valid, fix.measured_delay),
          .flags = fix.flags};
}

sonopose_PairHeading to_idl(const PairHeading& heading) {
  return {.address = heading.address,
          .event_sequence = heading.sequence,
          .emission_time = heading.emission_time_ns,
          .received_time = heading.received_time_ns,
          .heading = heading.heading_world_rad,
          .valid = heading.valid};
}

PairHeading from_idl(const sonopose_PairHeading& heading) {
  return {.address = heading.address,
          .sequence = heading.event_sequence,
          .emission_time_ns = heading.emission_time,
          .received_time_ns = heading.received_time,
          .heading_world_rad = heading.heading,
          .valid = heading.valid};
}

sonopose_FusedPose to_idl(const FusedPose& pose) {
  return {.address = pose.address,
          .event_sequence = pose.sequence,
          .time = pose.time_ns,
          .position = idl(pose.position_world_m),
          .orientation = idl(pose.q_body_to_world),
          .velocity = idl(pose.velocity_world_mps),
          .angular_velocity = idl(pose.angular_velocity_body_radps),
          .acceleration = idl(pose.acceleration_world_mps2),
          .gyro_bias = idl(pose.gyro_bias_body_radps),
          .position_std = idl(pose.position_std_m),
          .velocity_std = idl(pose.velocity_std_mps),
          .yaw_std = pose.yaw_std_rad,
          .trust = pose.trust,
          .since_valid_fix = pose.since_valid_fix_s,
          .reset_counter = pose.reset_counter,
          .status = pose.status,
          .imu_sensor_time = pose.imu_sensor_time_ns,
          .imu_bridge_time = pose.imu_bridge_time_ns,
          .fusion_in_time = pose.fusion_in_time_ns,
          .fusion_out_time = pose.fusion_out_time_ns};
}

FusedPose from_idl(const sonopose_FusedPose& pose) {
  return {.address = pose.address,
          .sequence = pose.event_sequence,
          .time_ns = pose.time,
          .position_world_m = native(pose.position),
          .q_body_to_world = native(pose.orientation),
          .velocity_world_mps = native(pose.velocity),
          .angular_velocity_body_radps = native(pose.angular_velocity),
          .acceleration_world_mps2 = native(pose.acceleration),
          .gyro_bias_body_radps = native(pose.gyro_bias),
          .position_std_m = native(pose.position_std),
          .velocity_std_mps = native(pose.velocity_std),
          .yaw_std_rad = pose.yaw_std,
          .trust = pose.trust,
          .since_valid_fix_s = pose.since_valid_fix,
          .reset_counter = pose.reset_counter,
          .status = pose.status,
          .imu_sensor_time_ns = pose.imu_sensor_time,
          .imu_bridge_time_ns = pose.imu_bridge_time,
          .fusion_in_time_ns = pose.fusion_in_time,
          .fusion_out_time_ns = pose.fusion_out_time};
}

sonopose_FixReport to_idl(const FixReport& report) {
  return {.address = report.address,
          .event_sequence = report.sequence,
          .emission_time = report.emission_time_ns,
          .applied_time = report.applied_time_ns,
          .position = idl(report.position_world_m),
          .shifted_position = idl(report.shifted_position_world_m),
          .innovation = report.innovation_m,
          .weight = report.weight,
          .trust = report.trust,
          .jump = idl(report.jump_world_m),
          .velocity_change = idl(report.velocity_change_world_mps),
          .yaw_change = report.yaw_change_rad,
          .flags = report.flags};
}

FixReport from_idl(const sonopose_FixReport& report) {
  return {.address = report.address,
          .sequence = report.event_sequence,
          .emission_time_ns = report.emission_time,
          .applied_time_ns = report.applied_time,
          .position_world_m = native(report.position),
          .shifted_position_world_m = native(report.shifted_position),
          .innovation_m = report.innovation,
          .weight = report.weight,
          .trust = report.trust,
          .jump_world_m = native(report.jump),
          .velocity_change_world_mps = native(report.velocity_change),
          .yaw_change_rad = report.yaw_change,
          .flags = report.flags};
}

sonopose_TruthSample to_idl(const TruthSample& truth) {
  return {.address = truth.address,
          .time = truth.time_ns,
          .position = idl(truth.position_world_m),
          .orientation = idl(truth.q_body_to_world),
          .velocity = idl(truth.velocity_world_mps)};
}

TruthSample from_idl(const sonopose_TruthSample& truth) {
  return {.address = truth.address,
          .time_ns = truth.time,
          .position_world_m = native(truth.position),
          .q_body_to_world = native(truth.orientation),
          .velocity_world_mps = native(truth.velocity)};
}

}  // namespace sonopose::dds
