#pragma once
/// \file
/// The measurements of a recording as the Kalman engine judged them in its forward run. Smoothing and the
/// estimation of parameters start from them.

#include <sonopose/estimation/kalman/state.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::estimation::offline {

/// Change of the engine's state when it changed to another track of fixes.
struct TrackChange {
  Vector3d jump_world_m = Vector3d::Zero();
  Vector3d velocity_change_world_mps = Vector3d::Zero();
  double yaw_change_rad = 0;
};

struct JudgedFix {
  kalman::FixMeasurement measured;
  std::uint64_t sequence = 0;  ///< event number of the fix
  std::uint32_t flags = 0;     ///< bits of FixFlag
  bool used = false;
  /// Covariance with which the engine used or rejected it: its own or the learned one, enlarged between the
  /// two gates.
  kalman::Matrix3d covariance_world_m2 = kalman::Matrix3d::Zero();
  std::optional<TrackChange> track_change{};  ///< set if the engine changed to the track of this fix
};

struct JudgedHeading {
  kalman::HeadingMeasurement measured;
  std::uint64_t sequence = 0;  ///< event number of the heading
  bool used = false;
  double variance_rad2 =
      0;  ///< variance with which the engine used or rejected it, enlarged between the gates
  double added_yaw_variance_rad2 =
      0;  ///< variance added to yaw before it, because headings disagreed for long
};

/// Conclusion of the engine from the IMU or from the silence of the fixes: gyro bias or zero velocity at
/// rest, or the weak bound on the velocity of dead reckoning.
struct StateMeasurement {
  TimeNs time_ns = 0;
  kalman::StateIndex index = kalman::at_velocity;  ///< first of three states
  Vector3d value = Vector3d::Zero();
  double variance = 0;  ///< variance of each component
};

/// Motion by readings that were dropped. They may have been right.
struct DroppedMotion {
  TimeNs time_ns = 0;  ///< time of the next sample
  Vector3d impulse_body_mps = Vector3d::Zero();
  Vector3d turn_body_rad = Vector3d::Zero();
};

/// Measurements between two starts of the estimate or silences of the IMU. Each list is in ascending time of
/// measurement. There may be no fix, and the last fixes and headings may be of a silence.
struct Segment {
  std::vector<kalman::ImuMeasurement> imu;  ///< calibrated; from at most a second before the first fix on.
                                            ///< Wrong readings are replaced by the last one before them
  std::vector<DroppedMotion> dropped;
  std::vector<JudgedFix> fixes;
  std::vector<JudgedHeading> headings;  ///< each after the fix of the same emission
  std::vector<StateMeasurement> states;
  double nominal_imu_period_s = 0;  ///< usual interval between samples
  TimeNs settled_ns =
      0;  ///< time at which the engine had followed a known yaw for some seconds; otherwise the end
  kalman::Filter settled;  ///< best filter of the engine at that time
};

/// Runs the Kalman engine over a recording's events, in the order of their arrival, and returns its
/// judgement. Events that the engine does not admit are left out, as are fixes and headings before the first
/// fix. Times are those of the measurement, with the delay compensated as the settings say. The verdicts are
/// those of the moment; only the fixes of a frozen track are withdrawn, from its first repetition on.
[[nodiscard]] std::vector<Segment> judged(const settings::Settings& settings, std::span<const Event> events);

}  // namespace sonopose::estimation::offline
