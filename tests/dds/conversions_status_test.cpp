#include "dds/field_filler.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <catch2/catch.hpp>

namespace sonopose::dds::test {
namespace {

FusedPose pose_with_distinct_fields() {
  Filler fill;
  FusedPose p;
  fill.all(p.address, p.sequence, p.time_ns, p.position_world_m, p.q_body_to_world, p.velocity_world_mps,
           p.angular_velocity_body_radps, p.acceleration_world_mps2, p.gyro_bias_body_radps, p.position_std_m,
           p.velocity_std_mps, p.yaw_std_rad, p.trust, p.since_valid_fix_s, p.reset_counter, p.status,
           p.imu_sensor_time_ns, p.imu_bridge_time_ns, p.fusion_in_time_ns, p.fusion_out_time_ns);
  return p;
}

TEST_CASE("Every field of a pose survives the way to IDL and back") {
  const FusedPose pose = pose_with_distinct_fields();
  const FusedPose back = from_idl(to_idl(pose));
  CHECK(back.address == pose.address);
  CHECK(back.sequence == pose.sequence);
  CHECK(back.time_ns == pose.time_ns);
  CHECK(back.position_world_m == pose.position_world_m);
  CHECK(back.q_body_to_world.coeffs() == pose.q_body_to_world.coeffs());
  CHECK(back.velocity_world_mps == pose.velocity_world_mps);
  CHECK(back.angular_velocity_body_radps == pose.angular_velocity_body_radps);
  CHECK(back.acceleration_world_mps2 == pose.acceleration_world_mps2);
  CHECK(back.gyro_bias_body_radps == pose.gyro_bias_body_radps);
  CHECK(back.position_std_m == pose.position_std_m);
  CHECK(back.velocity_std_mps == pose.velocity_std_mps);
  CHECK(back.yaw_std_rad == pose.yaw_std_rad);
  CHECK(back.trust == pose.trust);
  CHECK(back.since_valid_fix_s == pose.since_valid_fix_s);
  CHECK(back.reset_counter == pose.reset_counter);
  CHECK(back.status == pose.status);
  CHECK(back.imu_sensor_time_ns == pose.imu_sensor_time_ns);
  CHECK(back.imu_bridge_time_ns == pose.imu_bridge_time_ns);
  CHECK(back.fusion_in_time_ns == pose.fusion_in_time_ns);
  CHECK(back.fusion_out_time_ns == pose.fusion_out_time_ns);
}

TEST_CASE("Every field of a report survives the way to IDL and back") {
  Filler fill;
  FixReport r;
  fill.all(r.address, r.sequence, r.emission_time_ns, r.applied_time_ns, r.position_world_m,
           r.shifted_position_world_m, r.innovation_m, r.weight, r.trust, r.jump_world_m,
           r.velocity_change_world_mps, r.yaw_change_rad, r.flags);
  const FixReport back = from_idl(to_idl(r));
  CHECK(back.address == r.address);
  CHECK(back.sequence == r.sequence);
  CHECK(back.emission_time_ns == r.emission_time_ns);
  CHECK(back.applied_time_ns == r.applied_time_ns);
  CHECK(back.position_world_m == r.position_world_m);
  CHECK(back.shifted_position_world_m == r.shifted_position_world_m);
  CHECK(back.innovation_m == r.innovation_m);
  CHECK(back.weight == r.weight);
  CHECK(back.trust == r.trust);
  CHECK(back.jump_world_m == r.jump_world_m);
  CHECK(back.velocity_change_world_mps == r.velocity_change_world_mps);
  CHECK(back.yaw_change_rad == r.yaw_change_rad);
  CHECK(back.flags == r.flags);
}

TEST_CASE("Every field of a beacon's status survives the way to IDL and back") {
  Filler fill;
  BeaconStatus s;
  fill.all(s.address, s.time_ns, s.battery_v, s.rssi_dbm, s.imu_rate_hz, s.fix_rate_hz, s.heading_rate_hz,
           s.clock_offset_s, s.clock_jitter_s, s.frames, s.crc_errors, s.bytes_lost, s.unknown_frames,
           s.fixes_unavailable, s.samples_rejected, s.clock_resets, s.other_bridges, s.imu_deadlines_missed,
           s.fix_deadlines_missed, s.heading_deadlines_missed, s.liveliness_lost, s.readers_incompatible,
           s.samples_unwritten);
  const BeaconStatus back = from_idl(to_idl(s));
  CHECK(back.address == s.address);
  CHECK(back.time_ns == s.time_ns);
  CHECK(back.battery_v == s.battery_v);
  CHECK(back.rssi_dbm == s.rssi_dbm);
  CHECK(back.imu_rate_hz == s.imu_rate_hz);
  CHECK(back.fix_rate_hz == s.fix_rate_hz);
  CHECK(back.heading_rate_hz == s.heading_rate_hz);
  CHECK(back.clock_offset_s == s.clock_offset_s);
  CHECK(back.clock_jitter_s == s.clock_jitter_s);
  CHECK(back.frames == s.frames);
  CHECK(back.crc_errors == s.crc_errors);
  CHECK(back.bytes_lost == s.bytes_lost);
  CHECK(back.unknown_frames == s.unknown_frames);
  CHECK(back.fixes_unavailable == s.fixes_unavailable);
  CHECK(back.samples_rejected == s.samples_rejected);
  CHECK(back.clock_resets == s.clock_resets);
  CHECK(back.other_bridges == s.other_bridges);
  CHECK(back.imu_deadlines_missed == s.imu_deadlines_missed);
  CHECK(back.fix_deadlines_missed == s.fix_deadlines_missed);
  CHECK(back.heading_deadlines_missed == s.heading_deadlines_missed);
  CHECK(back.liveliness_lost == s.liveliness_lost);
  CHECK(back.readers_incompatible == s.readers_incompatible);
  CHECK(back.samples_unwritten == s.samples_unwritten);
  s.battery_v.reset();
  CHECK_FALSE(from_idl(to_idl(s)).battery_v);
  CHECK(from_idl(to_idl(s)).rssi_dbm);
  s.rssi_dbm.reset();
  CHECK_FALSE(from_idl(to_idl(s)).rssi_dbm);
}

TEST_CASE("Every field of the fusion's status survives the way to IDL and back") {
  Filler fill;
  FusionStatus s;
  fill.all(s.address, s.time_ns, s.imu_samples, s.fixes_used, s.fixes_rejected, s.headings, s.events_lost,
           s.events_duplicated, s.samples_invalid, s.imu_gaps, s.reset_counter, s.fusion_id, s.strength,
           s.imu_deadlines_missed, s.fix_deadlines_missed, s.heading_deadlines_missed, s.bridge_losses,
           s.pose_deadlines_missed, s.liveliness_lost, s.samples_lost, s.samples_rejected, s.incompatible_qos,
           s.poses_unwritten);
  s.imu_silent = true;
  s.role = FusionRole::stalled;
  const FusionStatus back = from_idl(to_idl(s));
  CHECK(back.address == s.address);
  CHECK(back.time_ns == s.time_ns);
  CHECK(back.imu_samples == s.imu_samples);
  CHECK(back.fixes_used == s.fixes_used);
  CHECK(back.fixes_rejected == s.fixes_rejected);
  CHECK(back.headings == s.headings);
  CHECK(back.events_lost == s.events_lost);
  CHECK(back.events_duplicated == s.events_duplicated);
  CHECK(back.samples_invalid == s.samples_invalid);
  CHECK(back.imu_gaps == s.imu_gaps);
  CHECK(back.reset_counter == s.reset_counter);
  CHECK(back.fusion_id == s.fusion_id);
  CHECK(back.strength == s.strength);
  CHECK(back.imu_silent);
  CHECK(back.role == FusionRole::stalled);
  CHECK(back.imu_deadlines_missed == s.imu_deadlines_missed);
  CHECK(back.fix_deadlines_missed == s.fix_deadlines_missed);
  CHECK(back.heading_deadlines_missed == s.heading_deadlines_missed);
  CHECK(back.bridge_losses == s.bridge_losses);
  CHECK(back.pose_deadlines_missed == s.pose_deadlines_missed);
  CHECK(back.liveliness_lost == s.liveliness_lost);
  CHECK(back.samples_lost == s.samples_lost);
  CHECK(back.samples_rejected == s.samples_rejected);
  CHECK(back.incompatible_qos == s.incompatible_qos);
  CHECK(back.poses_unwritten == s.poses_unwritten);
}

}  // namespace
}  // namespace sonopose::dds::test
