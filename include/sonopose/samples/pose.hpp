#pragma once
/// \file
/// What the engine gives: the fused pose at every IMU sample, and a report for every fix.

#include <sonopose/samples/samples.hpp>

#include <cstdint>

namespace sonopose {

/// What a consumer must know of a pose; bits of `FusedPose::status`.
enum PoseStatus : std::uint32_t {
  status_initialising = 1U << 0U,     ///< no position yet, or the start-up calibration is still running
  status_uncalibrated = 1U << 1U,     ///< the gyro was never still: zero bias is assumed
  status_stale = 1U << 2U,            ///< no valid fix for longer than setting 11: acceleration is ignored
  status_converging = 1U << 3U,       ///< the pose is being pulled over a large distance
  status_heading_unknown = 1U << 4U,  ///< no heading since the last half second (or ever)
  status_frozen_track = 1U << 5U,     ///< the fixes repeat one spot while the IMU moves
  status_predicted = 1U << 6U,        ///< between or beyond IMU samples, not at one
  status_imu_gap = 1U << 7U,          ///< the IMU was silent just before this pose
  status_low_trust = 1U << 8U,        ///< the ultrasonic track is being doubted (settings 15–22)
  status_rotating_fast = 1U << 9U     ///< the gyro-rate gate holds acceleration back (settings 35–37)
};

/// The pose of one beacon at one IMU sample.
struct FusedPose {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;  ///< of the IMU sample it was made at
  TimeNs time_ns = 0;          ///< when the pose holds (sensor time)
  Vector3d position_world_m = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d angular_velocity_body_radps = Vector3d::Zero();  ///< with the estimated bias taken off
  Vector3d acceleration_world_mps2 = Vector3d::Zero();      ///< with gravity taken off
  Vector3d gyro_bias_body_radps = Vector3d::Zero();
  Vector3d position_std_m = Vector3d::Zero();  ///< one standard deviation per world axis
  Vector3d velocity_std_mps = Vector3d::Zero();
  double yaw_std_rad = 0;
  double trust = 0;                 ///< 0…1, of the ultrasonic track
  double since_valid_fix_s = 0;     ///< since the last valid fix; infinite before the first
  std::uint32_t reset_counter = 0;  ///< rises when the engine was re-initialised: expect a jump
  std::uint32_t status = 0;         ///< bits of PoseStatus
  TimeNs imu_sensor_time_ns = 0;    ///< the IMU sample's way here: measured,
  TimeNs imu_bridge_time_ns = 0;    ///< published by the bridge,
  TimeNs fusion_in_time_ns = 0;     ///< taken by the fusion process,
  TimeNs fusion_out_time_ns = 0;    ///< and the pose written
};

/// What was done with a fix; bits of `FixReport::flags`.
enum FixFlag : std::uint32_t {
  fix_used = 1U << 0U,
  fix_outlier = 1U << 1U,
  fix_low_quality = 1U << 2U,
  fix_invalid = 1U << 3U,  ///< not finite, absurd, out of order, or not of this time
  fix_stuck_forced = 1U << 4U,
  fix_snapped_over = 1U << 5U,
  fix_snapped_under = 1U << 6U,
  fix_stale_recovered = 1U << 7U,
  fix_frozen = 1U << 8U,
  fix_first = 1U << 9U  ///< set the position outright: the first of a run
};

/// What the engine did with one fix, and why.
struct FixReport {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;                            ///< of the fix
  TimeNs emission_time_ns = 0;                           ///< of the fix
  TimeNs applied_time_ns = 0;                            ///< engine's time at which it was applied
  Vector3d position_world_m = Vector3d::Zero();          ///< as measured
  Vector3d shifted_position_world_m = Vector3d::Zero();  ///< moved on to `applied_time_ns` (setting 6)
  double innovation_m = 0;                                 ///< to the velocity-predicted position (setting 13)
  double weight = 0;                         ///< effective, after floor and trust (settings 13–15)
  double trust = 0;                          ///< 0…1
  Vector3d jump_world_m = Vector3d::Zero();  ///< applied at once (setting 4)
  Vector3d velocity_change_world_mps = Vector3d::Zero();  ///< applied at once (setting 3)
  double yaw_change_rad = 0;                              ///< applied at once (settings 31–33)
  std::uint32_t flags = 0;                              ///< bits of FixFlag
};

}  // namespace sonopose
