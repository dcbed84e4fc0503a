#pragma once
/// \file
/// Output of an engine: the fused pose at every IMU sample, a report on every fix, and its estimates of the
/// sensors.

#include <sonopose/samples/pose_status.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>

namespace sonopose {

inline namespace native {

/// Pose of one beacon at one IMU sample.
struct FusedPose {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;  ///< event number of its IMU sample
  TimeNs time_ns = 0;          ///< time of validity (sensor time)
  Vector3d position_world_m = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d angular_velocity_body_radps = Vector3d::Zero();  ///< without the estimated bias
  Vector3d acceleration_world_mps2 = Vector3d::Zero();      ///< without gravity
  Vector3d gyro_bias_body_radps = Vector3d::Zero();
  Covariance<6> pose_covariance;  ///< m, rad: position in world, then a rotation about the fixed world axes
  Covariance<3> velocity_covariance;  ///< (m/s)², world
  double trust = 0;                   ///< trust in the ultrasonic track, 0…1
  double since_valid_fix_s = 0;       ///< time since the last valid fix; infinite before the first
  std::uint32_t reset_counter = 0;    ///< increases when the engine is re-initialised: expect a jump
  std::uint32_t status = 0;           ///< bits of PoseStatus
  TimeNs imu_sensor_time_ns = 0;      ///< measurement of its IMU sample
  TimeNs imu_bridge_time_ns = 0;      ///< publication of this sample by the bridge
  TimeNs fusion_in_time_ns = 0;       ///< taking of this sample by the fusion
  TimeNs fusion_out_time_ns = 0;      ///< writing of the pose

  bool operator==(const FusedPose&) const = default;
};

}  // namespace native

/// Standard deviations of the position along the world axes. NaN: unknown.
inline Vector3d position_std_m(const FusedPose& pose) {
  return {pose.pose_covariance.std_dev(0), pose.pose_covariance.std_dev(1), pose.pose_covariance.std_dev(2)};
}

/// Standard deviations of the velocity along the world axes. NaN: unknown.
inline Vector3d velocity_std_mps(const FusedPose& pose) {
  return {pose.velocity_covariance.std_dev(0), pose.velocity_covariance.std_dev(1),
          pose.velocity_covariance.std_dev(2)};
}

/// Standard deviation of the yaw. NaN: unknown.
inline double yaw_std_rad(const FusedPose& pose) {
  return pose.pose_covariance.std_dev(5);
}

/// Treatment of a fix; bits of `FixReport::flags`.
enum FixFlag : std::uint32_t {
  fix_used = 1U << 0U,
  fix_outlier = 1U << 1U,
  fix_low_quality = 1U << 2U,
  fix_invalid = 1U << 3U,  ///< not finite, implausible, out of order or with an impossible time
  fix_stuck_forced = 1U << 4U,
  fix_snapped_over = 1U << 5U,
  fix_snapped_under = 1U << 6U,
  fix_stale_recovered = 1U << 7U,
  fix_frozen = 1U << 8U,
  fix_first = 1U << 9U,     ///< first fix of a run: sets the position directly
  fix_too_late = 1U << 10U  ///< measured too long ago for the engine to correct
};

inline namespace native {

/// Treatment of one fix by the engine, with the reasons.
struct FixReport {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;                    ///< event number of the fix
  TimeNs emission_time_ns = 0;                   ///< stamp of the fix
  TimeNs applied_time_ns = 0;                    ///< engine time of its application
  Vector3d position_world_m = Vector3d::Zero();  ///< position as measured
  Vector3d shifted_position_world_m =
      Vector3d::Zero();  ///< position moved forward to `applied_time_ns` (setting 6)
  Vector3d innovation_world_m = Vector3d::Zero();         ///< fix minus its prediction (setting 13)
  std::optional<Covariance<3>> innovation_covariance_m2;  ///< covariance in world axes
  std::optional<double> test_ratio;  ///< squared normalised innovation over its gate: above 1 is an outlier
  std::uint32_t hypothesis = 0;      ///< 1: an unused fix lies on another track
  std::uint32_t model = 0;           ///< model of the IMU in use: a kalman::ImuModel
  double weight = 0;                 ///< effective weight, after floor and trust (settings 13–15)
  double trust = 0;                  ///< 0…1
  Vector3d jump_world_m = Vector3d::Zero();               ///< immediate change (setting 4)
  Vector3d velocity_change_world_mps = Vector3d::Zero();  ///< immediate change (setting 3)
  double yaw_change_rad = 0;                              ///< immediate change (settings 31–33)
  std::uint32_t flags = 0;                                ///< bits of FixFlag

  bool operator==(const FixReport&) const = default;
};

/// An estimated value and its standard deviation.
struct ScalarEstimate {
  double value = 0;
  double std = 0;  ///< negative: unknown

  bool operator==(const ScalarEstimate&) const = default;
};

/// An estimated vector and its standard deviation per axis.
struct VectorEstimate {
  Vector3d value = Vector3d::Zero();
  Vector3d std = Vector3d::Zero();  ///< negative: unknown

  bool operator==(const VectorEstimate&) const = default;
};

/// Estimates of one engine about its sensors. A value that it does not estimate is empty.
struct Estimate {
  BeaconAddress address = 0;
  std::uint64_t fusion_id = 0;  ///< id of the process, as in FusionStatus
  TimeNs time_ns = 0;
  std::optional<VectorEstimate> gyro_bias_body_radps;
  std::optional<VectorEstimate> accelerometer_bias_body_mps2;
  std::optional<VectorEstimate> lever_arm_body_m;  ///< from the tracked point to the IMU
  std::optional<ScalarEstimate> delay_s;           ///< delay from the emission of a fix to its receipt
  std::optional<ScalarEstimate> fix_noise_m;       ///< standard deviation of a fix, per axis
  std::optional<ScalarEstimate> heading_noise_rad;

  bool operator==(const Estimate&) const = default;
};

}  // namespace native

/// Verdict of an engine on a fix.
enum class FixVerdict : std::uint8_t {
  used,
  down_weighted,  ///< used with less weight because its innovation is large
  rejected
};

/// Verdict on the fix of a report. The documented engine's weight falls with every innovation, so only an
/// outlier is down-weighted there. The Kalman engine, which reports an innovation covariance, lowers the
/// weight between its gates.
inline FixVerdict verdict_of(const FixReport& report) {
  if ((report.flags & fix_used) == 0) return FixVerdict::rejected;
  const bool has_gates = report.innovation_covariance_m2.has_value();
  const bool is_weak = (report.flags & fix_outlier) != 0 || (has_gates && report.weight < 1.0);
  return is_weak ? FixVerdict::down_weighted : FixVerdict::used;
}

inline bool is_down_weighted(const FixReport& report) {
  return verdict_of(report) == FixVerdict::down_weighted;
}

/// True if the innovation was computed. It is 0 for the first fix and for one rejected before, such as one of
/// low quality.
inline bool has_innovation(const FixReport& report) {
  const bool is_predicted = (report.flags & fix_used) != 0 && (report.flags & fix_first) == 0;
  return is_predicted || !report.innovation_world_m.isZero(0.0);
}

}  // namespace sonopose
