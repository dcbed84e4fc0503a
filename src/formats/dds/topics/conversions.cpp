#include "dds/topics/field_lists.hpp"
#include <sonopose/dds/topics/conversions.hpp>

namespace sonopose::dds::topics {
namespace {

// Constants have the same values on both sides, so flags and enumerations are copied as numbers.
static_assert(all_beacons == sonopose_ALL_BEACONS);
static_assert(static_cast<std::uint32_t>(ImuMeaning::unknown) == sonopose_IMU_MEANING_UNKNOWN);
static_assert(static_cast<std::uint32_t>(ImuMeaning::instant) == sonopose_IMU_MEANING_INSTANT);
static_assert(static_cast<std::uint32_t>(ImuMeaning::mean_since_last) == sonopose_IMU_MEANING_MEAN);
static_assert(ultrasonic_flag_user_button_1 == sonopose_ULTRASONIC_USER_BUTTON_1);
static_assert(ultrasonic_flag_user_button_2 == sonopose_ULTRASONIC_USER_BUTTON_2);
static_assert(ultrasonic_flag_other_hedge == sonopose_ULTRASONIC_OTHER_HEDGE);
static_assert(ultrasonic_flag_out_of_geofence == sonopose_ULTRASONIC_OUT_OF_GEOFENCE);
static_assert(ultrasonic_flag_pair_centre == sonopose_ULTRASONIC_PAIR_CENTRE);
static_assert(ultrasonic_flag_second_resolution == sonopose_ULTRASONIC_SECOND_RESOLUTION);
static_assert(ultrasonic_flag_set_pose == sonopose_ULTRASONIC_SET_POSE);
static_assert(heading_flag_of_body == sonopose_HEADING_OF_BODY);
static_assert(heading_flag_set_pose == sonopose_HEADING_SET_POSE);
static_assert(twist_velocity_x == sonopose_TWIST_VELOCITY_X);
static_assert(twist_velocity_y == sonopose_TWIST_VELOCITY_Y);
static_assert(twist_velocity_z == sonopose_TWIST_VELOCITY_Z);
static_assert(twist_angular_velocity_x == sonopose_TWIST_ANGULAR_VELOCITY_X);
static_assert(twist_angular_velocity_y == sonopose_TWIST_ANGULAR_VELOCITY_Y);
static_assert(twist_angular_velocity_z == sonopose_TWIST_ANGULAR_VELOCITY_Z);
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
static_assert(status_late == sonopose_STATUS_LATE);
static_assert(status_overloaded == sonopose_STATUS_OVERLOADED);
static_assert(status_imu_inconsistent == sonopose_STATUS_IMU_INCONSISTENT);
static_assert(status_fixes_inconsistent == sonopose_STATUS_FIXES_INCONSISTENT);
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
static_assert(fix_too_late == sonopose_FIX_TOO_LATE);
static_assert(static_cast<std::uint32_t>(LineState::closed) == sonopose_LINE_CLOSED);
static_assert(static_cast<std::uint32_t>(LineState::waiting) == sonopose_LINE_WAITING);
static_assert(static_cast<std::uint32_t>(LineState::open) == sonopose_LINE_OPEN);
static_assert(static_cast<std::uint32_t>(LineState::failed) == sonopose_LINE_FAILED);
static_assert(static_cast<std::uint32_t>(FusionRole::sole) == sonopose_ROLE_SOLE);
static_assert(static_cast<std::uint32_t>(FusionRole::warming) == sonopose_ROLE_WARMING);
static_assert(static_cast<std::uint32_t>(FusionRole::serving) == sonopose_ROLE_SERVING);
static_assert(static_cast<std::uint32_t>(FusionRole::stalled) == sonopose_ROLE_STALLED);
static_assert(static_cast<std::uint32_t>(LogLevel::debug) == sonopose_LOG_DEBUG);
static_assert(static_cast<std::uint32_t>(LogLevel::info) == sonopose_LOG_INFO);
static_assert(static_cast<std::uint32_t>(LogLevel::warning) == sonopose_LOG_WARNING);
static_assert(static_cast<std::uint32_t>(LogLevel::error) == sonopose_LOG_ERROR);
static_assert(static_cast<std::uint32_t>(LogLevel::failure) == sonopose_LOG_FAILURE);

template <class Native>
fields::IdlOf<Native> write(const Native& from) {
  fields::IdlOf<Native> to{};
  fields::write(fields::Pairs<Native>::list, from, to);
  return to;
}

template <class Native>
Native read(const fields::IdlOf<Native>& from) {
  Native to;
  fields::read(fields::Pairs<Native>::list, from, to);
  return to;
}

std::vector<sonopose_SettingAssignment> write(const std::vector<SettingAssignment>& assignments) {
  if (assignments.size() > sonopose_MAX_ASSIGNMENTS) {
    throw std::length_error(std::to_string(assignments.size()) + " settings, more than the " +
                            std::to_string(sonopose_MAX_ASSIGNMENTS) + " of one message");
  }
  std::vector<sonopose_SettingAssignment> list;
  list.reserve(assignments.size());
  for (const SettingAssignment& assignment : assignments) list.push_back(write(assignment));
  return list;
}

std::vector<SettingAssignment> read(const dds_sequence_sonopose_SettingAssignment& list) {
  std::vector<SettingAssignment> assignments;
  assignments.reserve(list._length);
  for (std::uint32_t i = 0; i < list._length; ++i) {
    assignments.push_back(read<SettingAssignment>(list._buffer[i]));
  }
  return assignments;
}

}  // namespace

sonopose_ImuSample to_idl(const ImuSample& native) {
  return write(native);
}
ImuSample from_idl(const sonopose_ImuSample& idl) {
  return read<ImuSample>(idl);
}

sonopose_UltrasonicFix to_idl(const UltrasonicFix& native) {
  return write(native);
}
UltrasonicFix from_idl(const sonopose_UltrasonicFix& idl) {
  return read<UltrasonicFix>(idl);
}

sonopose_PairHeading to_idl(const PairHeading& native) {
  return write(native);
}
PairHeading from_idl(const sonopose_PairHeading& idl) {
  return read<PairHeading>(idl);
}

sonopose_TwistSample to_idl(const TwistSample& native) {
  return write(native);
}
TwistSample from_idl(const sonopose_TwistSample& idl) {
  return read<TwistSample>(idl);
}

sonopose_StationaryBeacon to_idl(const StationaryBeacon& native) {
  return write(native);
}
StationaryBeacon from_idl(const sonopose_StationaryBeacon& idl) {
  return read<StationaryBeacon>(idl);
}

sonopose_FusedPose to_idl(const FusedPose& native) {
  return write(native);
}
FusedPose from_idl(const sonopose_FusedPose& idl) {
  return read<FusedPose>(idl);
}

sonopose_FixReport to_idl(const FixReport& native) {
  return write(native);
}
FixReport from_idl(const sonopose_FixReport& idl) {
  return read<FixReport>(idl);
}

sonopose_Estimate to_idl(const Estimate& native) {
  return write(native);
}
Estimate from_idl(const sonopose_Estimate& idl) {
  return read<Estimate>(idl);
}

sonopose_BeaconStatus to_idl(const BeaconStatus& native) {
  return write(native);
}
BeaconStatus from_idl(const sonopose_BeaconStatus& idl) {
  return read<BeaconStatus>(idl);
}

sonopose_LineStatus to_idl(const LineStatus& native) {
  return write(native);
}
LineStatus from_idl(const sonopose_LineStatus& idl) {
  return read<LineStatus>(idl);
}

sonopose_FusionStatus to_idl(const FusionStatus& native) {
  return write(native);
}
FusionStatus from_idl(const sonopose_FusionStatus& idl) {
  return read<FusionStatus>(idl);
}

sonopose_TruthSample to_idl(const TruthSample& native) {
  return write(native);
}
TruthSample from_idl(const sonopose_TruthSample& idl) {
  return read<TruthSample>(idl);
}

sonopose_LogLine to_idl(const LogLine& native) {
  return write(native);
}
LogLine from_idl(const sonopose_LogLine& idl) {
  return read<LogLine>(idl);
}

sonopose_SettingsReply to_idl(const SettingsReply& native) {
  return write(native);
}
SettingsReply from_idl(const sonopose_SettingsReply& idl) {
  return read<SettingsReply>(idl);
}

IdlView<sonopose_SettingsRequest> to_idl(const SettingsRequest& native) {
  return {write(native), write(native.assignments), &sonopose_SettingsRequest::assignments};
}
SettingsRequest from_idl(const sonopose_SettingsRequest& idl) {
  auto native = read<SettingsRequest>(idl);
  native.assignments = read(idl.assignments);
  return native;
}

IdlView<sonopose_EffectiveSettings> to_idl(const EffectiveSettings& native) {
  return {write(native), write(native.values), &sonopose_EffectiveSettings::values};
}
EffectiveSettings from_idl(const sonopose_EffectiveSettings& idl) {
  auto native = read<EffectiveSettings>(idl);
  native.values = read(idl.values);
  return native;
}

}  // namespace sonopose::dds::topics
