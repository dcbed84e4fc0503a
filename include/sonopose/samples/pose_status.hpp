#pragma once
/// \file
/// Status bits of a pose.

#include <cstdint>

namespace sonopose {

/// Conditions that a consumer of a pose must know; bits of `FusedPose::status`.
enum PoseStatus : std::uint32_t {
  status_initialising =
      1U << 0U,  ///< no position yet (documented engine: or it measures the gyroscope offset)
  status_uncalibrated = 1U << 1U,     ///< the gyro bias is not known well
  status_stale = 1U << 2U,            ///< no fix was used for longer than setting 11
  status_converging = 1U << 3U,       ///< the pose is being corrected by a large distance
  status_heading_unknown = 1U << 4U,  ///< yaw not known to 5° (documented engine: no heading for 0.5 s)
  status_frozen_track = 1U << 5U,     ///< the fixes repeat one position while the IMU moves
  status_predicted = 1U << 6U,        ///< the pose is between or beyond IMU samples, not at one
  status_imu_gap = 1U << 7U,          ///< the IMU was silent just before this pose, or repeats a sample
  status_low_trust = 1U << 8U,        ///< many of the last fixes were not used
  status_rotating_fast = 1U << 9U,    ///< documented engine: settings 35–37 suppress acceleration
  status_late = 1U << 10U,            ///< the IMU sample is old
  status_overloaded = 1U << 11U,      ///< the fusion cannot keep up with its input and skips poses
  status_imu_inconsistent =
      1U << 12U,  ///< gyroscope, accelerometer or mount contradict fixes, headings or gravity
  status_fixes_inconsistent =
      1U << 13U  ///< fixes at a default position or of a wrong height, or of another clock
};

}  // namespace sonopose
