#include <sonopose/dds/topics/conversions.hpp>

namespace sonopose::dds {
namespace {

static_assert(static_cast<std::uint32_t>(FusionRole::sole) == sonopose_ROLE_SOLE);
static_assert(static_cast<std::uint32_t>(FusionRole::warming) == sonopose_ROLE_WARMING);
static_assert(static_cast<std::uint32_t>(FusionRole::serving) == sonopose_ROLE_SERVING);
static_assert(static_cast<std::uint32_t>(FusionRole::stalled) == sonopose_ROLE_STALLED);

std::optional<double> if_valid(bool valid, double value) {
  return valid ? std::optional(value) : std::nullopt;
}

/// A number that is no role comes from a program of another version: nothing is claimed for it.
FusionRole role_of(std::uint32_t number) {
  return number <= sonopose_ROLE_STALLED ? static_cast<FusionRole>(number) : FusionRole::sole;
}

}  // namespace

sonopose_BeaconStatus to_idl(const BeaconStatus& status) {
  return {.address = status.address,
          .time = status.time_ns,
          .battery = status.battery_v.value_or(0.0),
          .battery_valid = status.battery_v.has_value(),
          .rssi = status.rssi_dbm.value_or(0.0),
          .rssi_valid = status.rssi_dbm.has_value(),
          .imu_rate = status.imu_rate_hz,
          .fix_rate = status.fix_rate_hz,
          .heading_rate = status.heading_rate_hz,
          .clock_offset = status.clock_offset_s,
          .clock_jitter = status.clock_jitter_s,
          .frames = status.frames,
          .crc_errors = status.crc_errors,
          .bytes_lost = status.bytes_lost,
          .unknown_frames = status.unknown_frames,
          .fixes_unavailable = status.fixes_unavailable,
          .samples_rejected = status.samples_rejected,
          .clock_resets = status.clock_resets,
          .other_bridges = status.other_bridges,
          .imu_deadlines_missed = status.imu_deadlines_missed,
          .fix_deadlines_missed = status.fix_deadlines_missed,
          .heading_deadlines_missed = status.heading_deadlines_missed,
          .liveliness_lost = status.liveliness_lost,
          .readers_incompatible = status.readers_incompatible,
          .samples_unwritten = status.samples_unwritten};
}

BeaconStatus from_idl(const sonopose_BeaconStatus& status) {
  return {.address = status.address,
          .time_ns = status.time,
          .battery_v = if_valid(status.battery_valid, status.battery),
          .rssi_dbm = if_valid(status.rssi_valid, status.rssi),
          .imu_rate_hz = status.imu_rate,
          .fix_rate_hz = status.fix_rate,
          .heading_rate_hz = status.heading_rate,
          .clock_offset_s = status.clock_offset,
          .clock_jitter_s = status.clock_jitter,
          .frames = status.frames,
          .crc_errors = status.crc_errors,
          .bytes_lost = status.bytes_lost,
          .unknown_frames = status.unknown_frames,
          .fixes_unavailable = status.fixes_unavailable,
          .samples_rejected = status.samples_rejected,
          .clock_resets = status.clock_resets,
          .other_bridges = status.other_bridges,
          .imu_deadlines_missed = status.imu_deadlines_missed,
          .fix_deadlines_missed = status.fix_deadlines_missed,
          .heading_deadlines_missed = status.heading_deadlines_missed,
          .liveliness_lost = status.liveliness_lost,
          .readers_incompatible = status.readers_incompatible,
          .samples_unwritten = status.samples_unwritten};
}

sonopose_FusionStatus to_idl(const FusionStatus& status) {
  return {.address = status.address,
          .fusion_id = status.fusion_id,
          .time = status.time_ns,
          .role = static_cast<std::uint32_t>(status.role),
          .strength = status.strength,
          .imu_silent = status.imu_silent,
          .imu_samples = status.imu_samples,
          .fixes_used = status.fixes_used,
          .fixes_rejected = status.fixes_rejected,
          .headings = status.headings,
          .events_lost = status.events_lost,
          .events_duplicated = status.events_duplicated,
          .samples_invalid = status.samples_invalid,
          .imu_gaps = status.imu_gaps,
          .reset_counter = status.reset_counter,
          .imu_deadlines_missed = status.imu_deadlines_missed,
          .fix_deadlines_missed = status.fix_deadlines_missed,
          .heading_deadlines_missed = status.heading_deadlines_missed,
          .bridge_losses = status.bridge_losses,
          .pose_deadlines_missed = status.pose_deadlines_missed,
          .liveliness_lost = status.liveliness_lost,
          .samples_lost = status.samples_lost,
          .samples_rejected = status.samples_rejected,
          .incompatible_qos = status.incompatible_qos,
          .poses_unwritten = status.poses_unwritten};
}

FusionStatus from_idl(const sonopose_FusionStatus& status) {
  return {.address = status.address,
          .fusion_id = status.fusion_id,
          .time_ns = status.time,
          .role = role_of(status.role),
          .strength = status.strength,
          .imu_silent = status.imu_silent,
          .imu_samples = status.imu_samples,
          .fixes_used = status.fixes_used,
          .fixes_rejected = status.fixes_rejected,
          .headings = status.headings,
          .events_lost = status.events_lost,
          .events_duplicated = status.events_duplicated,
          .samples_invalid = status.samples_invalid,
          .imu_gaps = status.imu_gaps,
          .reset_counter = status.reset_counter,
          .imu_deadlines_missed = status.imu_deadlines_missed,
          .fix_deadlines_missed = status.fix_deadlines_missed,
          .heading_deadlines_missed = status.heading_deadlines_missed,
          .bridge_losses = status.bridge_losses,
          .pose_deadlines_missed = status.pose_deadlines_missed,
          .liveliness_lost = status.liveliness_lost,
          .samples_lost = status.samples_lost,
          .samples_rejected = status.samples_rejected,
          .incompatible_qos = status.incompatible_qos,
          .poses_unwritten = status.poses_unwritten};
}

}  // namespace sonopose::dds
