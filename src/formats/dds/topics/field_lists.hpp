#pragma once
/// \file
/// Lists the field pairs of every native type. Only this file names both sides of a field.

#include "dds/topics/fields.hpp"
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/log_line.hpp>
#include <sonopose/samples/status.hpp>

#include <tuple>

namespace sonopose::dds::topics::fields {

/// The field pairs of a native type in `list`, and its IDL type.
template <class Native>
struct Pairs;

template <>
struct Pairs<ImuSample> {
  using N = ImuSample;
  using I = sonopose_ImuSample;
  static constexpr std::tuple list{
      field(&N::address, &I::address),
      field(&N::sequence, &I::event_sequence),
      field(&N::sensor_time_ns, &I::sensor_time),
      field(&N::bridge_time_ns, &I::bridge_time),
      field(&N::angular_velocity_body_radps, &I::angular_velocity),
      field(&N::specific_force_body_mps2, &I::specific_force),
      field(&N::magnetic_field_body_t, &I::magnetic_field, &I::magnetic_field_valid),
      enumeration(&N::meaning, &I::meaning, ImuMeaning::mean_since_last)};
};

template <>
struct Pairs<UltrasonicFix> {
  using N = UltrasonicFix;
  using I = sonopose_UltrasonicFix;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::sequence, &I::event_sequence),
                                   field(&N::emission_time_ns, &I::emission_time),
                                   field(&N::received_time_ns, &I::received_time),
                                   field(&N::position_world_m, &I::position),
                                   field(&N::covariance_world_m2, &I::covariance, &I::covariance_valid),
                                   non_negative(&N::quality_percent, &I::quality),
                                   field(&N::measured_delay_s, &I::measured_delay, &I::measured_delay_valid),
                                   field(&N::flags, &I::flags),
                                   field(&N::point_body_m, &I::point)};
};

template <>
struct Pairs<PairHeading> {
  using N = PairHeading;
  using I = sonopose_PairHeading;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::sequence, &I::event_sequence),
                                   field(&N::emission_time_ns, &I::emission_time),
                                   field(&N::received_time_ns, &I::received_time),
                                   field(&N::heading_world_rad, &I::heading),
                                   field(&N::valid, &I::valid),
                                   field(&N::std_rad, &I::heading_std),
                                   field(&N::flags, &I::flags)};
};

template <>
struct Pairs<TwistSample> {
  using N = TwistSample;
  using I = sonopose_TwistSample;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::sequence, &I::event_sequence),
                                   field(&N::emission_time_ns, &I::emission_time),
                                   field(&N::received_time_ns, &I::received_time),
                                   field(&N::velocity_body_mps, &I::velocity),
                                   field(&N::velocity_std_mps, &I::velocity_std),
                                   field(&N::angular_velocity_body_radps, &I::angular_velocity),
                                   field(&N::angular_velocity_std_radps, &I::angular_velocity_std),
                                   field(&N::axes, &I::axes)};
};

template <>
struct Pairs<StationaryBeacon> {
  using N = StationaryBeacon;
  using I = sonopose_StationaryBeacon;
  static constexpr std::tuple list{field(&N::address, &I::address), field(&N::time_ns, &I::time),
                                   field(&N::position_world_m, &I::position, &I::position_valid)};
};

template <>
struct Pairs<FusedPose> {
  using N = FusedPose;
  using I = sonopose_FusedPose;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::sequence, &I::event_sequence),
                                   field(&N::time_ns, &I::time),
                                   field(&N::position_world_m, &I::position),
                                   field(&N::q_body_to_world, &I::orientation),
                                   field(&N::velocity_world_mps, &I::velocity),
                                   field(&N::angular_velocity_body_radps, &I::angular_velocity),
                                   field(&N::acceleration_world_mps2, &I::acceleration),
                                   field(&N::gyro_bias_body_radps, &I::gyro_bias),
                                   field(&N::pose_covariance, &I::pose_covariance),
                                   field(&N::velocity_covariance, &I::velocity_covariance),
                                   field(&N::trust, &I::trust),
                                   field(&N::since_valid_fix_s, &I::since_valid_fix),
                                   field(&N::reset_counter, &I::reset_counter),
                                   field(&N::status, &I::status),
                                   field(&N::imu_sensor_time_ns, &I::imu_sensor_time),
                                   field(&N::imu_bridge_time_ns, &I::imu_bridge_time),
                                   field(&N::fusion_in_time_ns, &I::fusion_in_time),
                                   field(&N::fusion_out_time_ns, &I::fusion_out_time)};
};

template <>
struct Pairs<FixReport> {
  using N = FixReport;
  using I = sonopose_FixReport;
  static constexpr std::tuple list{
      field(&N::address, &I::address),
      field(&N::sequence, &I::event_sequence),
      field(&N::emission_time_ns, &I::emission_time),
      field(&N::applied_time_ns, &I::applied_time),
      field(&N::position_world_m, &I::position),
      field(&N::shifted_position_world_m, &I::shifted_position),
      field(&N::innovation_world_m, &I::innovation),
      field(&N::innovation_covariance_m2, &I::innovation_covariance, &I::innovation_covariance_valid),
      non_negative(&N::test_ratio, &I::test_ratio),
      field(&N::hypothesis, &I::hypothesis),
      field(&N::model, &I::model),
      field(&N::weight, &I::weight),
      field(&N::trust, &I::trust),
      field(&N::jump_world_m, &I::jump),
      field(&N::velocity_change_world_mps, &I::velocity_change),
      field(&N::yaw_change_rad, &I::yaw_change),
      field(&N::flags, &I::flags)};
};

template <>
struct Pairs<Estimate> {
  using N = Estimate;
  using I = sonopose_Estimate;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::fusion_id, &I::fusion_id),
                                   field(&N::time_ns, &I::time),
                                   field(&N::gyro_bias_body_radps, &I::gyro_bias),
                                   field(&N::accelerometer_bias_body_mps2, &I::accelerometer_bias),
                                   field(&N::lever_arm_body_m, &I::lever_arm),
                                   field(&N::delay_s, &I::delay),
                                   field(&N::fix_noise_m, &I::fix_noise),
                                   field(&N::heading_noise_rad, &I::heading_noise)};
};

template <>
struct Pairs<BeaconStatus> {
  using N = BeaconStatus;
  using I = sonopose_BeaconStatus;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::time_ns, &I::time),
                                   field(&N::battery_v, &I::battery, &I::battery_valid),
                                   field(&N::rssi_dbm, &I::rssi, &I::rssi_valid),
                                   field(&N::imu_rate_hz, &I::imu_rate),
                                   field(&N::fix_rate_hz, &I::fix_rate),
                                   field(&N::heading_rate_hz, &I::heading_rate),
                                   field(&N::clock_offset_s, &I::clock_offset),
                                   field(&N::clock_jitter_s, &I::clock_jitter),
                                   field(&N::frames, &I::frames),
                                   field(&N::crc_errors, &I::crc_errors),
                                   field(&N::bytes_lost, &I::bytes_lost),
                                   field(&N::unknown_frames, &I::unknown_frames),
                                   field(&N::fixes_unavailable, &I::fixes_unavailable),
                                   field(&N::samples_rejected, &I::samples_rejected),
                                   field(&N::clock_resets, &I::clock_resets),
                                   field(&N::other_bridges, &I::other_bridges),
                                   field(&N::imu_deadlines_missed, &I::imu_deadlines_missed),
                                   field(&N::fix_deadlines_missed, &I::fix_deadlines_missed),
                                   field(&N::heading_deadlines_missed, &I::heading_deadlines_missed),
                                   field(&N::liveliness_lost, &I::liveliness_lost),
                                   field(&N::readers_incompatible, &I::readers_incompatible),
                                   field(&N::samples_unwritten, &I::samples_unwritten),
                                   field(&N::samples_unrecorded, &I::samples_unrecorded)};
};

template <>
struct Pairs<LineStatus> {
  using N = LineStatus;
  using I = sonopose_LineStatus;
  static constexpr std::tuple list{cut_text(&N::name, &I::name),
                                   field(&N::bridge_id, &I::bridge_id),
                                   field(&N::time_ns, &I::time),
                                   enumeration(&N::state, &I::state, LineState::no_frames),
                                   field(&N::bytes, &I::bytes),
                                   field(&N::frames, &I::frames),
                                   field(&N::crc_errors, &I::crc_errors),
                                   field(&N::bytes_lost, &I::bytes_lost),
                                   field(&N::packets_refused, &I::packets_refused),
                                   cut_text(&N::text, &I::text)};
};

template <>
struct Pairs<FusionStatus> {
  using N = FusionStatus;
  using I = sonopose_FusionStatus;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::fusion_id, &I::fusion_id),
                                   field(&N::time_ns, &I::time),
                                   enumeration(&N::role, &I::role, FusionRole::stalled),
                                   field(&N::strength, &I::strength),
                                   field(&N::imu_silent, &I::imu_silent),
                                   field(&N::overloaded, &I::overloaded),
                                   field(&N::imu_samples, &I::imu_samples),
                                   field(&N::fixes_used, &I::fixes_used),
                                   field(&N::fixes_down_weighted, &I::fixes_down_weighted),
                                   field(&N::fixes_rejected, &I::fixes_rejected),
                                   field(&N::fixes_late, &I::fixes_late),
                                   field(&N::headings, &I::headings),
                                   field(&N::velocities_used, &I::velocities_used),
                                   field(&N::velocities_rejected, &I::velocities_rejected),
                                   field(&N::velocities_unused, &I::velocities_unused),
                                   field(&N::events_lost, &I::events_lost),
                                   field(&N::events_duplicated, &I::events_duplicated),
                                   field(&N::samples_invalid, &I::samples_invalid),
                                   field(&N::imu_gaps, &I::imu_gaps),
                                   field(&N::reset_counter, &I::reset_counter),
                                   field(&N::imu_deadlines_missed, &I::imu_deadlines_missed),
                                   field(&N::fix_deadlines_missed, &I::fix_deadlines_missed),
                                   field(&N::heading_deadlines_missed, &I::heading_deadlines_missed),
                                   field(&N::bridge_losses, &I::bridge_losses),
                                   field(&N::poses_late, &I::poses_late),
                                   field(&N::poses_skipped, &I::poses_skipped),
                                   field(&N::pose_deadlines_missed, &I::pose_deadlines_missed),
                                   field(&N::liveliness_lost, &I::liveliness_lost),
                                   field(&N::samples_lost, &I::samples_lost),
                                   field(&N::samples_rejected, &I::samples_rejected),
                                   field(&N::incompatible_qos, &I::incompatible_qos),
                                   field(&N::poses_unwritten, &I::poses_unwritten)};
};

template <>
struct Pairs<TruthSample> {
  using N = TruthSample;
  using I = sonopose_TruthSample;
  static constexpr std::tuple list{field(&N::address, &I::address), field(&N::time_ns, &I::time),
                                   field(&N::position_world_m, &I::position),
                                   field(&N::q_body_to_world, &I::orientation),
                                   field(&N::velocity_world_mps, &I::velocity)};
};

template <>
struct Pairs<SettingAssignment> {
  using N = SettingAssignment;
  using I = sonopose_SettingAssignment;
  static constexpr std::tuple list{field(&N::key, &I::key), field(&N::value, &I::value)};
};

/// Omits the list of assignments, which IdlView carries.
template <>
struct Pairs<SettingsRequest> {
  using N = SettingsRequest;
  using I = sonopose_SettingsRequest;
  static constexpr std::tuple list{field(&N::address, &I::address), field(&N::request_id, &I::request_id),
                                   field(&N::from_sequence, &I::from_event_sequence)};
};

template <>
struct Pairs<SettingsReply> {
  using N = SettingsReply;
  using I = sonopose_SettingsReply;
  static constexpr std::tuple list{field(&N::address, &I::address),
                                   field(&N::request_id, &I::request_id),
                                   field(&N::accepted, &I::accepted),
                                   cut_text(&N::reason, &I::reason),
                                   field(&N::from_sequence, &I::from_event_sequence),
                                   cut_text(&N::details, &I::details)};
};

/// Omits the list of assignments, which IdlView carries.
template <>
struct Pairs<EffectiveSettings> {
  using N = EffectiveSettings;
  using I = sonopose_EffectiveSettings;
  static constexpr std::tuple list{field(&N::address, &I::address), field(&N::time_ns, &I::time),
                                   field(&N::from_sequence, &I::from_event_sequence)};
};

template <>
struct Pairs<LogLine> {
  using N = LogLine;
  using I = sonopose_LogLine;
  static constexpr std::tuple list{
      cut_text(&N::host, &I::host),       field(&N::process_id, &I::process_id),
      field(&N::number, &I::number),      field(&N::time_ns, &I::time),
      cut_text(&N::program, &I::program), enumeration(&N::level, &I::level, LogLevel::failure),
      cut_text(&N::text, &I::text)};
};

template <class Native>
using IdlOf = typename Pairs<Native>::I;

}  // namespace sonopose::dds::topics::fields
